// SPDX-License-Identifier: BSD-3-Clause
// A store behind PgBouncer in transaction mode, where each transaction of a client may be on another connection.
#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/sync.h"
#include "slamdb/model/digest.h"
#include "tests/formats/store/atlases.h"
#include "tests/formats/store/server_sql.h"
#include "tests/support/pgbouncer.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::store_test {
namespace {

using detail::Concat;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StorePool : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    if (!PgBouncer::IsInstalled()) GTEST_SKIP() << "pgbouncer is not installed";
    database_ = PostgresqlServer::Shared().MakeDatabase();
  }
  std::string DirectUri() const { return PostgresqlServer::Shared().Uri(database_); }

  std::string database_;
  const Atlas sound_ = SoundAtlas(), odd_ = OddAtlas();
};

// The atlas with a mark that nobody else's has.
Atlas Marked(const Atlas& atlas, int who, int step) {
  Atlas marked = atlas;
  marked.maps[0].points[0].position = {static_cast<float>(who), static_cast<float>(step), 0};
  return marked;
}

TEST_F(StorePool, NothingIsLostOrMixedUpByManyThreadsOverFewConnections) {
  constexpr int kWriters = 5, kReaders = 3, kSaves = 6, kConnections = 3;
  const PgBouncer pool(PostgresqlServer::Shared(), kConnections);
  const std::string uri = pool.Uri(database_);
  Store::OpenForWriting(uri).Save("shared", sound_);
  std::atomic<int> writing = kWriters, mixed = 0, shared_saves = 0;
  std::vector<std::string> errors(kWriters + kReaders);
  const auto write = [&](int who) {
    for (int step = 0; step < kSaves; ++step) {
      Store store = Store::OpenForWriting(uri, {.sync = false, .lock_timeout = 60});
      store.Save(Concat("own", who), Marked(sound_, who, step), {.threads = 1});
      store.Save("shared", Marked(sound_, who, step), {.threads = 1});
      ++shared_saves;
      const Atlas own = store.Load(Concat("own", who, "@", step + 1), {.threads = 1});
      mixed += HashOf(own) != HashOf(Marked(sound_, who, step));
    }
  };
  const auto read = [&] {
    while (writing > 0) {
      Store store = Store::Open(uri);
      const Atlas shared = store.Load("shared", {.threads = 1});
      const auto& mark = shared.maps[0].points[0].position;
      const Atlas expected = Marked(sound_, static_cast<int>(mark.x()), static_cast<int>(mark.y()));
      mixed += HashOf(shared) != HashOf(expected) && HashOf(shared) != HashOf(sound_);
      for (const StoredAtlas& atlas : store.List()) mixed += !atlas.problem.empty();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < kWriters; ++i)
    threads.emplace_back([&, i] {
      errors[static_cast<std::size_t>(i)] = ErrorOf([&] { write(i); });
      --writing;
    });
  for (int i = 0; i < kReaders; ++i)
    threads.emplace_back([&, i] { errors[static_cast<std::size_t>(kWriters + i)] = ErrorOf(read); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(errors, ::testing::Each(""));
  EXPECT_EQ(mixed, 0);
  EXPECT_LE(std::stoi(SqlOn(DirectUri(),
                            "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND pid <> "
                            "pg_backend_pid()")),
            kConnections);

  Store store = Store::Open(uri);
  EXPECT_EQ(store.Names().size(), std::size_t{1 + kWriters});
  EXPECT_EQ(store.FindRevision("shared").number, static_cast<std::uint64_t>(1 + shared_saves));
  for (int who = 0; who < kWriters; ++who)
    for (int step = 0; step < kSaves; ++step)
      EXPECT_EQ(FirstDifference(store.Load(Concat("own", who, "@", step + 1)), Marked(sound_, who, step)), "");
}

// Nothing waits within a transaction for another one.
TEST_F(StorePool, OneConnectionIsEnoughForWhateverIsDone) {
  const PgBouncer pool(PostgresqlServer::Shared(), 1, "query_wait_timeout = 5");
  const std::string uri = pool.Uri(database_);
  Store store = Store::OpenForWriting(uri);
  store.Save("a", sound_);
  EXPECT_EQ(store.Save("a", odd_, {.verify = true}).revision, 2U);
  store.Tag("a@1", "kept");
  store.Branch("a@kept", "b");
  store.Restore("a@1");
  MapQuery query;
  query.times = MapQuery::Times{0, 1e12};
  EXPECT_THAT(Store::Open(uri).Find(query), ElementsAre("a", "b"));
  EXPECT_EQ(store.Log("a").size(), 3U);
  EXPECT_EQ(store.GiveUp({.keep = 1}).atlases.size(), 2U);
  EXPECT_GT(store.Stats().file_bytes, 0U);
  EXPECT_TRUE(MigrateStore(uri).steps.empty());
  EXPECT_EQ(FirstDifference(store.Load("a@kept"), sound_), "");
  store.Remove("b");
  EXPECT_THAT(store.Names(), ElementsAre("a"));
}

TEST_F(StorePool, WhoHasTheLockIsToldThroughThePool) {
  const PgBouncer pool(PostgresqlServer::Shared(), 2);
  const std::string uri = pool.Uri(database_);
  SaveOptions options;
  options.before_commit = [&] {
    Store other = Store::OpenForWriting(uri, {.lock_timeout = 0.05});
    const std::string error = ErrorOf([&] { other.Save("a", odd_); });
    EXPECT_THAT(error, HasSubstr("'a' is locked by slamdb "));
    EXPECT_THAT(error, HasSubstr("server process"));
    other.Save("b", odd_);  // of another name goes on
  };
  Store::OpenForWriting(uri).Save("a", sound_, options);
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), sound_), "");
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("b"), odd_), "");
  Store::OpenForWriting(uri, {.lock_timeout = 0.05}).Save("a", odd_);  // nobody leaves a lock behind
}

TEST_F(StorePool, StoresAreSynchronizedThroughIt) {
  const PgBouncer pool(PostgresqlServer::Shared(), 1);
  TemporaryFolder folder;
  const std::string file = folder / "robot.db", uri = pool.Uri(database_);
  SaveIn(file, sound_, "mine");
  Store::OpenForWriting(uri).Save("theirs", odd_);
  const SyncReport report = SyncStores(file, uri);
  EXPECT_EQ(report.Count(SyncResult::kCopied), 2U);
  EXPECT_EQ(SyncStores(uri, file).same, 2U);
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("mine"), sound_), "");
  EXPECT_EQ(FirstDifference(LoadFrom(file, "theirs"), odd_), "");
}

// What earlier clients left in the connections: settings, tables of their own.
TEST_F(StorePool, WhatOthersLeaveInConnectionsHarmsNothing) {
  const PgBouncer pool(PostgresqlServer::Shared(), 1);
  const std::string uri = pool.Uri(database_);
  Store::OpenForWriting(uri).Save("a", sound_);
  for (const char* left : {"SET search_path TO pg_catalog", "CREATE TEMPORARY TABLE atlas (row integer)",
                           "CREATE TEMPORARY TABLE map_point (row integer)", "SET bytea_output TO escape",
                           "SET extra_float_digits TO -10", "SET IntervalStyle TO sql_standard", "SET DateStyle TO SQL",
                           "SET TimeZone TO 'Asia/Kathmandu'", "SET default_transaction_isolation TO serializable"})
    ASSERT_THAT(SqlOn(uri, left), ::testing::Not(HasSubstr("ERROR"))) << left;
  EXPECT_EQ(Store::OpenForWriting(uri).Save("a", odd_).revision, 2U);
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), odd_), "");
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a@1"), sound_), "");
  EXPECT_EQ(Store::Open(uri).List().size(), 1U);
}

TEST_F(StorePool, AServerThatIsKilledBehindItIsAnErrorAndTheNextSaveWorks) {
  PostgresqlServer server;
  const PgBouncer pool(server, 2, "server_login_retry = 1");
  const std::string uri = pool.Uri(server.MakeDatabase());
  Store::OpenForWriting(uri).Save("a", sound_);
  SaveOptions options;
  options.before_commit = [&] { server.Kill(); };
  const std::string error = ErrorOf([&] { Store::OpenForWriting(uri).Save("a", odd_, options); });
  EXPECT_THAT(error, HasSubstr("try again"));
  server.Start();
  int tries = 0;
  while (!ErrorOf([&] { EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), sound_), ""); }).empty() && tries < 50) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ++tries;
  }
  EXPECT_LT(tries, 50);
  EXPECT_EQ(Store::OpenForWriting(uri).Save("a", odd_).revision, 2U);
}

TEST_F(StorePool, APoolThatIsTooSmallSaysSo) {
  const PgBouncer pool(PostgresqlServer::Shared(), 1, "query_wait_timeout = 1");
  const std::string uri = pool.Uri(database_);
  SaveOptions options;
  options.before_commit = [&] {
    std::thread([&] {
      const std::string error = ErrorOf([&] { Store::Open(uri).Load("a"); });
      EXPECT_THAT(error, HasSubstr("query_wait_timeout"));
      EXPECT_THAT(error, HasSubstr("try again"));
    }).join();
  };
  Store::OpenForWriting(uri).Save("a", sound_, options);
}

}  // namespace
}  // namespace slamdb::store_test
