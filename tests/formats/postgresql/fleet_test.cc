// SPDX-License-Identifier: BSD-3-Clause
// A store on three servers: one has the list of atlases, the other two their partitions.
#include "slamdb/formats/postgresql/fleet.h"

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <thread>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/store/report.h"
#include "slamdb/model/digest.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::store_test {
namespace {

using postgresql::Connection;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::uint32_t kPartitions = 4;
constexpr int kAtlases = 8;

class FleetTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!PostgresqlServer::IsInstalled()) return;
    // A commit that is to be confirmed by a standby waits for ever, as there is none: those that ask for it.
    servers_[0] =
        std::make_unique<PostgresqlServer>("synchronous_standby_names = 'nobody'\nsynchronous_commit = local");
    for (std::size_t i = 1; i < servers_.size(); ++i) servers_[i] = std::make_unique<PostgresqlServer>();
  }
  static void TearDownTestSuite() {
    for (auto& server : servers_) server.reset();
  }
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    store_ = servers_[0]->Uri(servers_[0]->MakeDatabase());
    one_ = servers_[1]->TcpUri(servers_[1]->MakeDatabase());  // with a password
    two_ = servers_[2]->Uri(servers_[2]->MakeDatabase());
  }

  void Init() const { InitFleet(store_, kPartitions, std::vector<std::string>{one_, two_}); }
  Store Writer() const { return Store::OpenForWriting(store_, {.sync = false}); }
  Store Reader() const { return Store::Open(store_); }

  // A small atlas that differs from others with another number.
  static Atlas Numbered(int number) {
    Atlas atlas = SoundAtlas();
    atlas.maps[0].points[0].position.x() = static_cast<float>(number);
    return atlas;
  }
  static std::string NameOf(int number) { return "a" + std::to_string(number); }
  void SaveSome() const {
    Store store = Writer();
    for (int i = 0; i < kAtlases; ++i) store.Save(NameOf(i), Numbered(i));
  }
  static void ExpectHolds(Store& store, const std::string& name, const Atlas& atlas) {
    EXPECT_EQ(FirstDifference(store.Load(name), atlas), "") << name;
  }

  static std::int64_t Number(const std::string& uri, const std::string& sql) {
    Connection connection(uri);
    return connection.Integer(sql);
  }
  static void Do(const std::string& uri, const std::string& sql) {
    Connection connection(uri);
    connection.Execute(sql);
  }
  static std::int64_t PartitionOf(const std::string& store, const std::string& name) {
    return Number(store, "SELECT number FROM generate_series(0, 3) AS number, slamdb.atlas WHERE name = '" + name +
                             "' AND satisfies_hash_partition('slamdb.map'::regclass, 4, number, row)");
  }
  // Some atlas of the partition.
  std::string NameIn(std::int64_t partition) const {
    for (int i = 0; i < kAtlases; ++i)
      if (PartitionOf(store_, NameOf(i)) == partition) return NameOf(i);
    ADD_FAILURE() << "none of " << kAtlases << " atlases is in partition " << partition;
    return NameOf(0);
  }
  // All rows that a server has of a partition.
  static std::int64_t RowsOn(const std::string& uri, std::int64_t partition) {
    std::int64_t rows = 0;
    for (const std::string_view table : postgresql::PartitionedTables())
      rows += Number(uri, "SELECT count(*) FROM slamdb." + std::string(table) + "_" + std::to_string(partition));
    return rows;
  }
  // As after a crash of the store's server between the commits of the newest revision: it is forgotten here alone.
  void ForgetNewest(const std::string& name, std::uint64_t hash_before) const {
    Do(store_,
       "DELETE FROM slamdb.revision USING slamdb.atlas WHERE revision.atlas = atlas.row AND number = "
       "atlas.revision AND name = '" +
           name + "'; UPDATE slamdb.atlas SET revision = revision - 1, hash = " +
           std::to_string(static_cast<std::int64_t>(hash_before)) + " WHERE name = '" + name + "'");
  }

  static std::array<std::unique_ptr<PostgresqlServer>, 3> servers_;
  std::string store_, one_, two_;
};

std::array<std::unique_ptr<PostgresqlServer>, 3> FleetTest::servers_;

std::vector<std::string> ServersOf(const Fleet& fleet) {
  std::vector<std::string> servers;
  for (const FleetPartition& each : fleet.partitions) servers.push_back(each.server);
  return servers;
}

TEST_F(FleetTest, IsMadeOnceAndNamesItsServers) {
  Init();
  const Fleet fleet = ReadFleet(store_);
  EXPECT_TRUE(fleet.ok());
  ASSERT_THAT(fleet.partitions, SizeIs(kPartitions));
  EXPECT_THAT(fleet.partitions[0].server, HasSubstr("127.0.0.1:" + std::to_string(servers_[1]->port()) + "/"));
  EXPECT_THAT(fleet.partitions[1].server, HasSubstr(servers_[2]->folder()));
  EXPECT_EQ(fleet.partitions[2].server, fleet.partitions[0].server);
  Init();
  SaveSome();
  Init();
  std::uint64_t atlases = 0;
  for (const FleetPartition& each : ReadFleet(store_).partitions) {
    atlases += each.atlases;
    EXPECT_EQ(each.bytes > 0, each.atlases > 0);
  }
  EXPECT_EQ(atlases, static_cast<std::uint64_t>(kAtlases));
  EXPECT_THAT(ErrorOf([&] { InitFleet(store_, 5, std::vector<std::string>{one_, two_}); }), HasSubstr("already"));
}

TEST_F(FleetTest, KeepsThePasswordWhereItBelongs) {
  Init();
  EXPECT_EQ(Number(store_, "SELECT count(*) FROM pg_user_mappings WHERE umoptions::text LIKE '%password=S3cret%'"), 2);
  EXPECT_THAT(ServersOf(ReadFleet(store_)), Each(Not(HasSubstr("S3cret"))));
  EXPECT_EQ(Number(store_, "SELECT count(*) FROM pg_foreign_server WHERE srvoptions::text LIKE '%S3cret%'"), 0);
}

TEST_F(FleetTest, HalfOfItIsCompleted) {
  servers_[2]->Stop();
  EXPECT_THAT(ErrorOf([&] { Init(); }), HasSubstr("no server answers"));
  servers_[2]->Start();
  int limit = 1;  // of the calls after which it is stopped
  for (bool is_done = false; !is_done; ++limit) {
    int calls = 0;
    FleetOptions options;
    options.progress = [&](std::string_view, double) {
      if (++calls > limit) throw std::runtime_error("stop");
    };
    try {
      InitFleet(store_, kPartitions, std::vector<std::string>{one_, two_}, options);
      is_done = true;
    } catch (const std::runtime_error& error) {
      ASSERT_STREQ(error.what(), "stop");
    }
  }
  EXPECT_GT(limit, 5);
  Init();
  EXPECT_TRUE(ReadFleet(store_).ok());
  SaveSome();
  Store store = Reader();
  for (int i = 0; i < kAtlases; ++i) ExpectHolds(store, NameOf(i), Numbered(i));
}

TEST_F(FleetTest, IsNotMadeOfWhatHoldsSomething) {
  Writer().Save("a", Numbered(1));
  EXPECT_THAT(ErrorOf([&] { Init(); }), AllOf(HasSubstr("holds 1 atlases"), HasSubstr("another database")));
  const std::string other = servers_[0]->Uri(servers_[0]->MakeDatabase());
  EXPECT_THAT(ErrorOf([&] { InitFleet(other, 2, std::vector<std::string>{store_}); }),
              HasSubstr("holds a store, or partitions of another one"));
  InitFleet(other, 2, std::vector<std::string>{one_});
  const std::string third = servers_[0]->Uri(servers_[0]->MakeDatabase());
  EXPECT_THAT(ErrorOf([&] { InitFleet(third, 2, std::vector<std::string>{one_}); }),
              HasSubstr("partitions of another"));
  EXPECT_THAT(ErrorOf([&] { Store::Open(one_); }), HasSubstr("name that one"));
  EXPECT_THAT(ErrorOf([&] { MovePartition(store_, 0, one_); }), HasSubstr("no fleet"));
  EXPECT_THAT(ErrorOf([&] { MovePartition(other, 2, one_); }), HasSubstr("has no partition 2"));
}

TEST_F(FleetTest, AtlasesAreOnTheServerOfTheirPartition) {
  Init();
  SaveSome();
  Store store = Writer();
  for (int i = 0; i < kAtlases; ++i) store.Save(NameOf(i), Numbered(100 + i));
  for (std::int64_t partition = 0; partition < kPartitions; ++partition) {
    const std::string& uri = partition % 2 == 0 ? one_ : two_;
    NameIn(partition);
    EXPECT_GT(RowsOn(uri, partition), 0) << partition;
    EXPECT_EQ(Number(store_, "SELECT count(*) FROM pg_class WHERE relkind = 'f' AND relname = 'map_" +
                                 std::to_string(partition) + "'"),
              1);
    const std::string table = "slamdb.map_" + std::to_string(partition);
    EXPECT_EQ(Number(uri, "SELECT count(DISTINCT atlas) FROM " + table),
              Number(store_, "SELECT count(DISTINCT atlas) FROM " + table));
  }
  for (int i = 0; i < kAtlases; ++i) {
    ExpectHolds(store, NameOf(i), Numbered(100 + i));
    ExpectHolds(store, NameOf(i) + "@1", Numbered(i));
  }
  store.Remove(NameIn(0));
  store.Remove(NameIn(1));
  for (const std::string& uri : {one_, two_}) Number(uri, "SELECT count(*) FROM slamdb.map");
  EXPECT_EQ(RepairFleet(store_), 0U);
}

TEST_F(FleetTest, KeepsWhatIsHardToKeep) {
  Init();
  Store store = Writer();
  const Atlas real = [] {
    Notices notices;
    return ReadOrbslam3(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", {}, notices);
  }();
  for (int i = 0; i < 4; ++i) {
    store.Save("odd" + std::to_string(i), OddAtlas());
    store.Save("real" + std::to_string(i), real);
    store.Save("empty" + std::to_string(i), Atlas{});
  }
  for (int i = 0; i < 4; ++i) {
    ExpectHolds(store, "odd" + std::to_string(i), OddAtlas());
    ExpectHolds(store, "real" + std::to_string(i), real);
    ExpectHolds(store, "empty" + std::to_string(i), Atlas{});
  }
}

TEST_F(FleetTest, RevisionsAreReadAgainAndGivenUp) {
  Init();
  Store store = Writer();
  for (const char* name : {"a", "b", "c", "d"}) {
    Atlas atlas = SoundAtlas();
    std::vector<Atlas> saved;
    for (int i = 0; i < 6; ++i) {
      Map& map = atlas.maps[static_cast<std::size_t>(i) % atlas.maps.size()];
      map.points[static_cast<std::size_t>(i)].position.x() += 1;
      map.keyframes[0].features.keypoints[static_cast<std::size_t>(i)].x += 1;
      if (i % 2 == 1) map.points.pop_back();
      store.Save(name, atlas);
      saved.push_back(atlas);
    }
    for (std::size_t i = 0; i < saved.size(); ++i) ExpectHolds(store, name + ("@" + std::to_string(i + 1)), saved[i]);
    store.Tag(name + std::string("@2"), "kept");
    const GiveUpReport report = store.GiveUp({.keep = 2}, name);
    EXPECT_THAT(report.atlases[0].revisions, ElementsAre(1, 3, 4));
    EXPECT_GT(report.pictures, 0U);
    ExpectHolds(store, name + std::string("@kept"), saved[1]);
    ExpectHolds(store, name + std::string("@5"), saved[4]);
    ExpectHolds(store, name, saved[5]);
  }
  EXPECT_EQ(RepairFleet(store_), 0U);
}

TEST_F(FleetTest, SearchesFanOut) {
  Init();
  SaveSome();
  Store store = Reader();
  const Map map = Numbered(5).maps[0];
  MapQuery query;
  query.near = MapQuery::Ball{map.points[0].position.cast<double>(), 0.01};
  EXPECT_THAT(store.Find(query), ElementsAre("a5"));
  query = {};
  query.times = MapQuery::Times{map.keyframes[0].timestamp - 0.5, map.keyframes[0].timestamp + 0.5};
  EXPECT_THAT(store.Find(query), SizeIs(kAtlases));
  query = {};
  query.keyframes = MapQuery::Ids{map.keyframes[0].id.value(), map.keyframes[0].id.value()};
  EXPECT_THAT(store.Find(query), SizeIs(kAtlases));
}

TEST_F(FleetTest, OneServerDownTakesItsAtlasesAlone) {
  Init();
  SaveSome();
  const std::string there = NameIn(1), here = NameIn(0);
  std::vector<std::string> gone;
  for (int i = 0; i < kAtlases; ++i)
    if (PartitionOf(store_, NameOf(i)) % 2 == 1) gone.push_back(NameOf(i));
  const auto kept = static_cast<std::size_t>(kAtlases) - gone.size();
  Store before = Reader();
  before.Load(there);  // its server's connection is lost, too
  servers_[2]->Kill();
  for (int again = 0; again < 2; ++again) {
    Store store = again == 0 ? std::move(before) : Reader();
    EXPECT_THAT(ErrorOf([&] { store.Load(there); }), Not(IsEmpty()));
    EXPECT_THAT(ErrorOf([&] { store.Load(there); }),
                AllOf(HasSubstr("another server"), HasSubstr(servers_[2]->folder()), HasSubstr("fleet status")));
    EXPECT_NO_THROW(store.Load(here));
    EXPECT_THAT(store.List(), SizeIs(kAtlases));
    EXPECT_THAT(store.Log(), SizeIs(kAtlases));
    MapQuery query;
    query.times = MapQuery::Times{-1e12, 1e12};
    std::vector<std::string> unsearched;
    EXPECT_THAT(store.Find(query, &unsearched), SizeIs(kept));
    EXPECT_EQ(unsearched, gone);
    EXPECT_THAT(ErrorOf([&] { store.Find(query); }), HasSubstr("another server"));
    const Atlas atlas = Numbered(0);
    const auto& descriptors = atlas.maps[0].keyframes[0].features.descriptors;
    const std::vector<Descriptor> picture(descriptors.begin(), descriptors.end());
    const std::span<const Descriptor> pictures[] = {picture};
    const StoredPlaces places = store.PlacesLike(pictures);
    EXPECT_EQ(places.unreachable, gone);
    for (const std::string& name : places.unknown) EXPECT_THAT(gone, Not(::testing::Contains(name)));
    EXPECT_EQ(store.Stats().partitions_elsewhere, static_cast<std::uint64_t>(kPartitions));
  }
  Store writer = Writer();
  EXPECT_THAT(ErrorOf([&] { writer.Save(there, Numbered(77)); }), HasSubstr("another server"));
  EXPECT_THAT(ErrorOf([&] { writer.Remove(there); }), HasSubstr("another server"));
  EXPECT_EQ(writer.Save(here, Numbered(78)).revision, 2U);
  const Fleet fleet = ReadFleet(store_);
  EXPECT_FALSE(fleet.ok());
  for (const FleetPartition& each : fleet.partitions) EXPECT_EQ(each.failure.empty(), each.number % 2 == 0);
  EXPECT_EQ(RepairFleet(store_), 0U);  // of those that answer
  servers_[2]->Start();
  EXPECT_TRUE(ReadFleet(store_).ok());
  ExpectHolds(writer, there, Numbered(there[1] - '0'));
  EXPECT_EQ(writer.Save(there, Numbered(77)).revision, 2U);
  ExpectHolds(writer, there, Numbered(77));
}

// The other server has committed the second revision, and the store's has not.
TEST_F(FleetTest, WhatAnInterruptedSaveLeftIsNotReadAndGoes) {
  Init();
  Store store = Writer();
  Atlas second = Numbered(2), third = Numbered(3);
  second.maps.pop_back();
  second.maps[0].keyframes[0].features.keypoints[0].x += 1;
  third.maps[0].points.pop_back();
  for (const char* name : {"a", "b", "c"}) {
    const std::uint64_t hash = store.Save(name, Numbered(1)).hash;
    store.Save(name, second);
    ForgetNewest(name, hash);
    ExpectHolds(store, name, Numbered(1));
  }
  EXPECT_EQ(store.Save("a", third).revision, 2U);
  ExpectHolds(store, "a", third);
  ExpectHolds(store, "a@1", Numbered(1));
  EXPECT_EQ(store.Save("b", second).revision, 2U);  // the same again
  ExpectHolds(store, "b", second);
  EXPECT_GT(RepairFleet(store_), 0U);  // of c
  EXPECT_EQ(RepairFleet(store_), 0U);
  ExpectHolds(store, "c", Numbered(1));
  EXPECT_EQ(store.Save("c", third).revision, 2U);
  ExpectHolds(store, "c", third);
}

// Of a new atlas not even its row number is known any more, and the next atlas gets it.
TEST_F(FleetTest, WhatAnInterruptedFirstSaveLeftGoes) {
  Init();
  Store store = Writer();
  for (int i = 0; i < 4; ++i) {
    store.Save("lost", OddAtlas());
    Do(store_,
       "DELETE FROM slamdb.atlas WHERE name = 'lost'; SELECT setval(pg_get_serial_sequence('slamdb.atlas', "
       "'row'), nextval(pg_get_serial_sequence('slamdb.atlas', 'row')) - 1, false)");
    const std::string name = "new" + std::to_string(i);
    store.Save(name, Numbered(i));
    ExpectHolds(store, name, Numbered(i));
    store.Save(name, OddAtlas());
    ExpectHolds(store, name, OddAtlas());
  }
  store.Save("lost", OddAtlas());
  Do(store_, "DELETE FROM slamdb.atlas WHERE name = 'lost'");
  EXPECT_GT(RepairFleet(store_), 0U);
  EXPECT_EQ(RepairFleet(store_), 0U);
}

// Between the commits a transaction waits for the lock of all who notify, which is held by one that waits for a
// standby.
TEST_F(FleetTest, TheStoresServerIsKilledBetweenTheCommits) {
  Init();
  Store(Writer()).Save("a", Numbered(1));
  const std::string table = "slamdb.map_" + std::to_string(PartitionOf(store_, "a"));
  const std::string& uri = PartitionOf(store_, "a") % 2 == 0 ? one_ : two_;
  Do(store_,
     "CREATE FUNCTION notify_of_save() RETURNS trigger LANGUAGE plpgsql AS 'BEGIN NOTIFY saved; RETURN NULL; "
     "END'; CREATE TRIGGER saved AFTER INSERT ON slamdb.history EXECUTE FUNCTION notify_of_save()");
  std::thread holder([&] {
    EXPECT_THAT(
        ErrorOf([&] { Do(store_, "SET synchronous_commit = on; BEGIN; CREATE TABLE held (); NOTIFY held; COMMIT"); }),
        Not(IsEmpty()));
  });
  const std::string waits = "SELECT count(*) FROM pg_stat_activity WHERE wait_event = 'SyncRep'";
  while (Number(store_, waits) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::thread saver(
      [&] { EXPECT_THAT(ErrorOf([&] { Store(Writer()).Save("a", Numbered(2)); }), HasSubstr("try again")); });
  while (Number(uri, "SELECT count(*) FROM " + table + " WHERE since = 2") == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  servers_[0]->Kill();
  holder.join();
  saver.join();
  servers_[0]->Start();
  Do(store_, "DROP TRIGGER saved ON slamdb.history");
  EXPECT_GT(Number(uri, "SELECT count(*) FROM " + table + " WHERE since = 2"), 0);
  Store store = Writer();
  EXPECT_EQ(store.FindRevision("a").number, 1U);
  ExpectHolds(store, "a", Numbered(1));
  EXPECT_EQ(store.Save("a", Numbered(3)).revision, 2U);
  ExpectHolds(store, "a", Numbered(3));
  ExpectHolds(store, "a@1", Numbered(1));
}

TEST_F(FleetTest, APartitionMovesWhileOthersRead) {
  InitFleet(store_, kPartitions, std::vector<std::string>{one_});
  SaveSome();
  std::atomic<bool> stop{false};
  std::atomic<int> loads{0};
  std::vector<std::thread> readers;
  for (int reader = 0; reader < 2; ++reader)
    readers.emplace_back([&, reader] {
      Store store = Reader();
      for (int i = reader; !stop; ++i, ++loads) {
        const std::string problem = ErrorOf([&] { ExpectHolds(store, NameOf(i % kAtlases), Numbered(i % kAtlases)); });
        EXPECT_EQ(problem, "");
      }
    });
  for (const std::uint32_t partition : {1, 3}) {
    MovePartition(store_, partition, two_);
    EXPECT_EQ(RowsOn(one_, partition), 0);
    EXPECT_GT(RowsOn(two_, partition), 0);
  }
  const int at_the_end = loads;
  while (loads < at_the_end + 2 * kAtlases) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  stop = true;
  for (std::thread& reader : readers) reader.join();
  const Fleet fleet = ReadFleet(store_);
  EXPECT_EQ(fleet.partitions[1].server, fleet.partitions[3].server);
  EXPECT_NE(fleet.partitions[0].server, fleet.partitions[1].server);
  MovePartition(store_, 1, two_);  // is there
  const std::string name = NameIn(1);
  Store store = Writer();
  EXPECT_EQ(store.Save(name, Numbered(55)).revision, 2U);
  ExpectHolds(store, name, Numbered(55));
  MovePartition(store_, 1, one_);  // and back
  ExpectHolds(store, name, Numbered(55));
  EXPECT_EQ(RowsOn(two_, 1), 0);
}

TEST_F(FleetTest, PartitionsLeaveTheStoresOwnServerWhileOthersRead) {
  InitFleet(store_, kPartitions, {});
  EXPECT_THAT(ServersOf(ReadFleet(store_)), Each(IsEmpty()));
  SaveSome();
  std::atomic<bool> stop{false};
  std::thread reader([&] {
    Store store = Reader();
    for (int i = 0; !stop; ++i) {
      const std::string problem = ErrorOf([&] { ExpectHolds(store, NameOf(i % kAtlases), Numbered(i % kAtlases)); });
      EXPECT_EQ(problem, "");
    }
  });
  for (const std::uint32_t partition : {0, 2}) MovePartition(store_, partition, one_);
  stop = true;
  reader.join();
  EXPECT_GT(RowsOn(one_, 0), 0);
  EXPECT_THAT(ReadFleet(store_).partitions[1].server, IsEmpty());
  Store store = Writer();
  for (int i = 0; i < kAtlases; ++i) {
    EXPECT_EQ(store.Save(NameOf(i), Numbered(200 + i)).revision, 2U);
    ExpectHolds(store, NameOf(i), Numbered(200 + i));
  }
}

TEST_F(FleetTest, AMoveThatWasInterruptedIsDoneAgain) {
  Init();
  SaveSome();
  FleetOptions options;
  options.progress = [](std::string_view what, double) {
    if (what == "copying map_point") throw std::runtime_error("stop");
  };
  EXPECT_THROW(MovePartition(store_, 1, one_, options), std::runtime_error);
  options.progress = [](std::string_view what, double) {
    if (what == "waiting for readers") throw std::runtime_error("stop");
  };
  Connection reader(store_);  // reads for a long time
  reader.Execute("BEGIN; SELECT count(*) FROM slamdb.map");
  EXPECT_THROW(MovePartition(store_, 1, one_, options), std::runtime_error);
  EXPECT_GT(RowsOn(two_, 1), 0);  // they may still be read
  reader.Execute("COMMIT");
  MovePartition(store_, 1, one_);
  EXPECT_EQ(RowsOn(two_, 1), 0);
  Store store = Reader();
  for (int i = 0; i < kAtlases; ++i) ExpectHolds(store, NameOf(i), Numbered(i));
}

TEST_F(FleetTest, SavesWaitForAMove) {
  Init();
  SaveSome();
  Connection mover(store_);
  mover.Execute("BEGIN");
  postgresql::LockPartition(mover, 1, {});
  Store impatient = Store::OpenForWriting(store_, {.lock_timeout = 0.05});
  EXPECT_THAT(ErrorOf([&] { impatient.Save(NameIn(1), Numbered(9)); }), HasSubstr("partition 1: is being moved"));
  EXPECT_EQ(impatient.Save(NameIn(0), Numbered(9)).revision, 2U);
  mover.Execute("COMMIT");
  EXPECT_EQ(impatient.Save(NameIn(1), Numbered(9)).revision, 2U);
}

TEST_F(FleetTest, ManyWriteAtOnce) {
  Init();
  constexpr int kWriters = 4, kSaves = 4;
  std::vector<std::thread> writers;
  for (int w = 0; w < kWriters; ++w)
    writers.emplace_back([&, w] {
      Store store = Store::OpenForWriting(store_, {.sync = false, .lock_timeout = 60});
      for (int s = 0; s < kSaves; ++s) {
        store.Save("own" + std::to_string(w), Numbered(10 * w + s));
        store.Save("shared", Numbered(10 * w + s));
      }
    });
  for (std::thread& writer : writers) writer.join();
  Store store = Reader();
  for (int w = 0; w < kWriters; ++w) ExpectHolds(store, "own" + std::to_string(w), Numbered(10 * w + kSaves - 1));
  const std::uint64_t newest = store.FindRevision("shared").number;
  EXPECT_EQ(newest, static_cast<std::uint64_t>(kWriters * kSaves));
  for (std::uint64_t number = 1; number <= newest; ++number)
    EXPECT_NO_THROW(store.Load("shared@" + std::to_string(number)));
}

}  // namespace
}  // namespace slamdb::store_test
