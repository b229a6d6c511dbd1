// SPDX-License-Identifier: BSD-3-Clause
// What can go wrong with a store on a server, and what is left then: the revision before, whole, or the new one.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <initializer_list>
#include <stdexcept>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"
#include "tests/formats/store/server_sql.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::store_test {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class StoreOnServer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    database_ = Server().MakeDatabase();
    uri_ = Server().Uri(database_);
    Store::OpenForWriting(uri_).Save("a", first_);
  }
  static PostgresqlServer& Server() { return PostgresqlServer::Shared(); }

  std::string Sql(const std::string& sql) const { return SqlOn(uri_, sql); }
  std::string UriOf(const std::string& user) const {
    std::string uri = uri_;
    return uri.replace(uri.find(PostgresqlServer::kUser), PostgresqlServer::kUser.size(), user);
  }

  void ExpectFirst() { EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("a"), first_), ""); }
  void ExpectSecondCanBeSaved() {
    EXPECT_EQ(Store::OpenForWriting(uri_).Save("a", second_).revision, 2U);
    EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("a"), second_), "");
    EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("a@1"), first_), "");
  }

  std::string database_, uri_;
  Atlas first_ = SoundAtlas(), second_ = OddAtlas();
};

TEST_F(StoreOnServer, KilledRightBeforeTheCommitHasTheRevisionBefore) {
  SaveOptions options;
  options.before_commit = [] { Server().Kill(); };
  const std::string error = ErrorOf([&] { Store::OpenForWriting(uri_).Save("a", second_, options); });
  EXPECT_THAT(error, HasSubstr("try again"));
  Server().Start();
  ExpectFirst();
  ExpectSecondCanBeSaved();
}

TEST_F(StoreOnServer, KilledInTheMiddleOfRowsHasTheRevisionBefore) {
  SaveOptions options;
  bool is_killed = false;
  options.progress = [&](std::string_view stage, double fraction) {
    if (stage != "saving" || fraction < 0.3 || is_killed) return;
    is_killed = true;
    Server().Kill();
  };
  const std::string error = ErrorOf([&] { Store::OpenForWriting(uri_).Save("a", second_, options); });
  EXPECT_TRUE(is_killed);
  EXPECT_THAT(error, HasSubstr("try again"));
  Server().Start();
  ExpectFirst();
  ExpectSecondCanBeSaved();
}

TEST_F(StoreOnServer, StoppedByItsAdministratorSaysSo) {
  SaveOptions options;
  options.before_commit = [] { Server().Restart(); };
  EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(uri_).Save("a", second_, options); }), HasSubstr("try again"));
  ExpectFirst();
  ExpectSecondCanBeSaved();
}

TEST_F(StoreOnServer, ALostConnectionIsAnErrorAndTheNextOneWorks) {
  Store store = Store::OpenForWriting(uri_);
  SaveOptions options;
  options.before_commit = [&] {
    Sql("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND pid <> "
        "pg_backend_pid()");
  };
  EXPECT_THAT(ErrorOf([&] { store.Save("a", second_, options); }), HasSubstr("try again"));
  EXPECT_THAT(ErrorOf([&] { store.Load("a"); }), Not(::testing::IsEmpty()));
  ExpectFirst();
  ExpectSecondCanBeSaved();
}

// Of this process: the one that the thread keeps for the next store that it opens.
TEST_F(StoreOnServer, ManyStoresOneBehindTheOtherTakeOneConnection) {
  const auto count = [&] {
    return Sql(
        "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND application_name LIKE "
        "'slamdb%'");
  };
  for (int i = 0; i < 5; ++i) ExpectFirst();
  EXPECT_EQ(count(), "1");
  const pid_t child = ::fork();
  if (child == 0) {
    const bool same = FirstDifference(Store::Open(uri_).Load("a"), first_).empty();
    ::_exit(same ? 0 : 1);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(count(), "1");  // not taken away by the child
  Server().Restart();
  ExpectFirst();
}

// A save whose commit arrived though nobody heard of it is done again, and changes nothing.
TEST_F(StoreOnServer, ToTryAgainIsSafeWhereTheCommitHadArrived) {
  ExpectSecondCanBeSaved();
  EXPECT_TRUE(Store::OpenForWriting(uri_).Save("a", second_).unchanged);
  EXPECT_EQ(Store::Open(uri_).FindRevision("a").number, 2U);
}

TEST_F(StoreOnServer, RowsThatSomebodyEditedAreSeenAndWrittenAnew) {
  struct Edit {
    const char *table, *sql;
  };
  for (const auto& [table, sql] : std::initializer_list<Edit>{
           {"map_point",
            "UPDATE slamdb.map_point SET x = x + 1 WHERE until = 2147483647 AND row = (SELECT min(row) FROM "
            "slamdb.map_point)"},
           {"map_point",
            "UPDATE slamdb.map_point SET seen_by = seen_by[2:], left_keypoints = left_keypoints[2:], right_keypoints = "
            "right_keypoints[2:] WHERE until = 2147483647 AND cardinality(seen_by) > 1"},
           {"keyframe", "UPDATE slamdb.keyframe SET tx = 7 WHERE until = 2147483647"},
           {"keyframe",
            "UPDATE slamdb.keyframe SET weights[1] = 7000 WHERE until = 2147483647 AND cardinality(weights) > 0"},
           {"keyframe_features", "DELETE FROM slamdb.keyframe_features WHERE until = 2147483647 AND keyframe % 2 = 0"},
           {"keyframe_features", "UPDATE slamdb.picture SET columns = substr(columns, 1, 40)"},
           {"keyframe_features", "DELETE FROM slamdb.picture"},
           {"map", "UPDATE slamdb.map SET inertial = 9 WHERE until = 2147483647"},
           {"revision", "DELETE FROM slamdb.map_point WHERE until = 2147483647 AND row % 7 = 0"},
           {"revision", "DELETE FROM slamdb.map WHERE until = 2147483647"},
           {"camera", "UPDATE slamdb.camera SET parameters = '[1,2,oops]', exact = NULL WHERE until = 2147483647"},
           {"camera", "UPDATE slamdb.camera SET id = id + 1 WHERE until = 2147483647"},
           {"revision", "DELETE FROM slamdb.camera WHERE until = 2147483647"},
           {"revision", "UPDATE slamdb.revision SET next_map = 4711"}}) {
    ASSERT_THAT(Sql(sql), Not(HasSubstr("ERROR"))) << sql;
    const std::string error = ErrorOf([&] { Store::Open(uri_).Load("a"); });
    EXPECT_THAT(error, HasSubstr(detail::Concat("table ", table, ","))) << sql;
    Store::OpenForWriting(uri_).Save("a", first_, {.verify = true});
    ExpectFirst();
  }
}

// Its row tells lists of an atlas; what is the newest tell the revisions.
// An index holds extents against each other when it has many: differences of some are no numbers.
TEST_F(StoreOnServer, MapsOfAnyTimesAndPlacesAreFound) {
  Atlas atlas = SynthesizeAtlas({.maps = 300, .keyframes = 2, .points = 10, .features = 60});
  constexpr double kOdd[] = {5e-324, -5e-324, 1e-310, -1, 0, 1.7e308, -1.7e308};
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    Map& map = atlas.maps[i];
    for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp += 1e9 + 1e6 * static_cast<double>(i * i % 997);
    if (i % 10 == 0) map.keyframes[0].timestamp = kOdd[i / 10 % std::size(kOdd)];
    if (i % 7 == 0) map.points[0].position = {1e-45F, -3e38F, 3e38F};
  }
  Store::OpenForWriting(uri_, {.sync = false}).Save("odd", atlas);
  EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("odd"), atlas), "");
  EXPECT_THAT(Store::Open(uri_).Find(MapQuery{.times = MapQuery::Times{-2, 1}}), ElementsAre("odd"));
}

TEST_F(StoreOnServer, AnEditedRowOfTheAtlasMisleadsNeitherLoadsNorSaves) {
  Store::OpenForWriting(uri_).Save("a", second_);
  for (const char* edit : {"UPDATE slamdb.atlas SET revision = 1", "UPDATE slamdb.atlas SET revision = 2147483647",
                           "UPDATE slamdb.atlas SET hash = (SELECT hash FROM slamdb.revision WHERE number = 1)"}) {
    Sql(edit);
    EXPECT_EQ(Store::Open(uri_).List()[0].problem, "another revision than the newest") << edit;
    EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("a"), second_), "") << edit;
    const std::uint64_t before = Store::Open(uri_).FindRevision("a").number;
    EXPECT_EQ(Store::OpenForWriting(uri_).Save("a", first_).revision, before + 1) << edit;
    ExpectFirst();
    EXPECT_EQ(Store::OpenForWriting(uri_).Save("a", second_).revision, before + 2) << edit;
    EXPECT_EQ(Store::Open(uri_).List()[0].problem, "");
  }
}

TEST_F(StoreOnServer, RowsThatTheDatabaseKeepsOutAreAnError) {
  for (const char* table : {"map_point", "keyframe", "map", "revision", "atlas", "keyframe_features"}) {
    Sql(detail::Concat(
        "CREATE FUNCTION slamdb.nothing() RETURNS trigger LANGUAGE plpgsql AS 'BEGIN RETURN NULL; END'"));
    ASSERT_THAT(Sql(detail::Concat("CREATE TRIGGER nothing BEFORE INSERT OR UPDATE ON slamdb.", table,
                                   " FOR EACH ROW EXECUTE FUNCTION slamdb.nothing()")),
                Not(HasSubstr("ERROR")));
    EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(uri_).Save("a", second_); }), HasSubstr("a trigger, a rule"))
        << table;
    Sql("DROP FUNCTION slamdb.nothing CASCADE");
    ExpectFirst();
  }
}

// As through PgBouncer, where what another client made stays in the session.
TEST_F(StoreOnServer, TemporaryTablesOfOthersHideNothing) {
  postgresql::Connection connection(uri_);
  connection.Execute("CREATE TEMPORARY TABLE atlas AS SELECT * FROM slamdb.atlas WHERE false");
  const postgresql::Transaction transaction(connection, postgresql::Transaction::Kind::kRead);
  EXPECT_EQ(connection.Integer("SELECT count(*) FROM atlas"), 1);
}

TEST_F(StoreOnServer, ATagThatIsSetWhileRevisionsAreGivenUpWaitsForThem) {
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", second_);
  SaveOptions options;
  options.before_commit = [&] {
    EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(uri_, {.lock_timeout = 0.05}).Tag("a@1", "kept"); }),
                HasSubstr("'a' is locked by"));
  };
  store.Save("a", first_, options);
  store.Tag("a@1", "kept");
  store.GiveUp({.keep = 1});
  EXPECT_EQ(FirstDifference(store.Load("a@kept"), first_), "");
}

TEST_F(StoreOnServer, WhatTheLogHasLostStaysByItsTag) {
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", second_);
  store.Save("a", first_);
  store.Tag("a@1", "kept");
  Sql("SET session_replication_role = replica; DELETE FROM slamdb.history WHERE revision <= 2");
  EXPECT_TRUE(store.GiveUp({.keep = 50}).atlases[0].revisions.empty());
  EXPECT_THAT(store.GiveUp({.keep_days = 7}).atlases[0].revisions, ::testing::ElementsAre(2)) << "saved long ago";
  EXPECT_EQ(FirstDifference(store.Load("a@kept"), first_), "");
}

TEST_F(StoreOnServer, GivingUpLeavesNoEarlierRows) {
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", second_);
  store.Save("a", first_);
  ASSERT_NE(Sql("SELECT count(*) FROM slamdb.map_point WHERE until <> 2147483647"), "0");
  store.GiveUp({.keep = 1});
  for (const char* table :
       {"camera", "map", "keyframe", "keyframe_features", "map_point", "landmark", "repeated_entry"})
    EXPECT_EQ(Sql(detail::Concat("SELECT count(*) FROM slamdb.", table, " WHERE until <> 2147483647")), "0") << table;
  ExpectFirst();
}

// Rows that somebody ended in a revision to come would be in those that come before it.
TEST_F(StoreOnServer, RowsThatSomebodyEndedAreWrittenAnew) {
  ASSERT_THAT(Sql("UPDATE slamdb.map_point SET until = 4 WHERE row % 3 = 0"), Not(HasSubstr("ERROR")));
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", first_, {.verify = true});
  store.Save("a", second_);
  store.Save("a", first_);
  EXPECT_EQ(FirstDifference(store.Load("a@2"), first_), "");
  EXPECT_EQ(FirstDifference(store.Load("a@3"), second_), "");
  EXPECT_EQ(FirstDifference(store.Load("a@4"), first_), "");
}

TEST_F(StoreOnServer, ASaveThatVerifiesTakesWhatSavesHaveWrittenForWhole) {
  EXPECT_TRUE(Store::OpenForWriting(uri_).Save("a", first_, {.verify = true}).unchanged);
  EXPECT_EQ(Store::OpenForWriting(uri_).Save("a", second_, {.verify = true}).revision, 2U);
  EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("a"), second_), "");
}

TEST_F(StoreOnServer, WhatKeyframesLookLikeComesBackWithASaveOfWhatIsThere) {
  const std::string words = Sql("SELECT count(*) FROM slamdb.keyframe_words");
  EXPECT_NE(words, "0");
  Sql("DELETE FROM slamdb.keyframe_words");
  EXPECT_TRUE(Store::OpenForWriting(uri_).Save("a", first_).unchanged);
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.keyframe_words"), words);
}

TEST_F(StoreOnServer, PlacesAreThoseOfTheNewestRevision) {
  const auto places = [&](const std::string& atlas) {
    return Sql(
        "SELECT string_agg(map || ' ' || number || ' ' || shown || ' ' || words, ',' ORDER BY map, number) FROM "
        "slamdb.place JOIN slamdb.atlas ON atlas.row = place.atlas WHERE name = '" +
        atlas + "'");
  };
  Atlas room = SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 20, .points = 300, .seed = 3, .threads = 1});
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", room);
  const std::string whole = places("a");
  EXPECT_EQ(std::ranges::count(whole, ','), 2);  // eight, eight and four
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.place WHERE shown <> bit_count(words) OR shown = 0"), "0");
  room.maps[0].keyframes.erase(room.maps[0].keyframes.begin() + 9);
  store.Save("a", room);
  store.Save("fresh", room);
  EXPECT_NE(places("a"), whole);
  EXPECT_EQ(places("a"), places("fresh"));
  Sql("DELETE FROM slamdb.place");
  EXPECT_TRUE(store.Save("a", room).unchanged);
  EXPECT_NE(places("a"), "");
  room.maps.clear();
  store.Save("a", room);
  EXPECT_EQ(places("a"), "");
}

// More than are fetched as a whole.
TEST_F(StoreOnServer, OfManyAtlasesThoseThatKnowAPictureAreNamed) {
  Store store = Store::OpenForWriting(uri_, {.sync = false});
  const auto room = [](std::uint64_t seed) {
    return SynthesizeAtlas(
        {.sensor = Sensor::kStereo, .keyframes = 2, .points = 150, .features = 200, .seed = seed, .threads = 1});
  };
  for (std::uint64_t house = 0; house < 27; ++house) {
    Atlas atlas = room(10 * house);
    for (std::uint64_t i = 1; i < 10; ++i) {
      atlas.maps.push_back(room(10 * house + i).maps[0]);
      atlas.maps.back().id = MapId(i);
    }
    store.Save(detail::Concat("house", house), atlas);
  }
  const Atlas asked = room(217), other = room(270);
  const auto descriptors_of = [](const Atlas& atlas) { return LeftDescriptors(atlas.maps[0].keyframes[0].features); };
  std::vector<Descriptor> picture(descriptors_of(asked).begin(), descriptors_of(asked).end());
  std::copy_n(descriptors_of(other).begin(), picture.size() / 3, picture.begin());
  const std::span<const Descriptor> pictures[] = {picture, descriptors_of(other)};
  const StoredPlaces places = store.PlacesLike(pictures);
  ASSERT_FALSE(places.by_picture[0].empty());
  EXPECT_EQ(places.by_picture[0][0].atlas, "house21");
  EXPECT_EQ(places.by_picture[0][0].map, MapId(7));
  EXPECT_EQ(places.by_picture[0][0].keyframe, asked.maps[0].keyframes[0].id);
  for (const StoredPlace& place : places.by_picture[1]) EXPECT_LT(place.likeness, places.by_picture[0][0].likeness / 2);
  EXPECT_THAT(places.unknown, ::testing::IsEmpty());
  const StoredPlaces without = store.PlacesLike(pictures, {.without = {"house21"}});
  for (const StoredPlace& place : without.by_picture[0]) EXPECT_NE(place.atlas, "house21");
}

TEST_F(StoreOnServer, GivingUpWaitsForOneAtlasAtATimeAsLongAsItIsTold) {
  Store store = Store::OpenForWriting(uri_);
  store.Save("a", second_);
  store.Save("b", first_);
  store.Save("b", second_);
  SaveOptions options;
  options.before_commit = [&] {
    const GiveUpReport planned = Store::OpenForWriting(uri_).GiveUp({.keep = 1, .dry_run = true});
    EXPECT_EQ(planned.atlases.size(), 2U);  // waits for nobody
    EXPECT_GT(planned.bytes, 0U);
    const std::string error = ErrorOf([&] { Store::OpenForWriting(uri_, {.lock_timeout = 0.05}).GiveUp({.keep = 1}); });
    EXPECT_THAT(error, HasSubstr("'b' is locked by"));
  };
  store.Save("b", first_, options);
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.revision JOIN slamdb.atlas ON atlas = row WHERE name = 'a'"), "1");
  EXPECT_EQ(store.GiveUp({.keep = 1}).atlases[1].revisions.size(), 2U);
}

TEST_F(StoreOnServer, HasWhatItNeedsInOneSchemaWithComments) {
  EXPECT_EQ(Sql("SELECT count(*) FROM pg_class WHERE relkind = 'r' AND relnamespace = 'public'::regnamespace"), "0");
  EXPECT_THAT(Sql("SELECT string_agg(relname, ' ') FROM pg_class WHERE relkind = 'p' AND relnamespace = "
                  "'slamdb'::regnamespace AND obj_description(oid) IS NULL"),
              "");
}

TEST_F(StoreOnServer, ViewsTellWhatTheAtlasHolds) {
  const Map& map = first_.maps[0];
  const std::string id = std::to_string(map.id.value());
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.v_map_point WHERE map = " + id), std::to_string(map.points.size()));
  std::size_t observations = 0, links = 0;
  for (const MapPoint& point : map.points) observations += point.observations.size();
  for (const KeyFrame& keyframe : map.keyframes)
    links += keyframe.connections.size() + keyframe.children.size() + keyframe.loop_edges.size() +
             keyframe.merge_edges.size();
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.v_observation WHERE map = " + id), std::to_string(observations));
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.v_keyframe_link WHERE map = " + id), std::to_string(links));
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.v_keyframe_pose WHERE map = " + id), std::to_string(map.keyframes.size()));
  EXPECT_EQ(Sql("SELECT count(*) FROM slamdb.v_dangling"), "0");
  EXPECT_EQ(Sql("SELECT hash FROM slamdb.v_revision"), Sql("SELECT hash FROM slamdb.v_atlas"));
  for (const char* view : {"v_camera", "v_map", "v_keyframe", "v_landmark"})
    EXPECT_THAT(Sql(detail::Concat("SELECT count(*) FROM slamdb.", view)), Not(HasSubstr("ERROR"))) << view;
}

// ---- who may do what: schema/postgresql/roles.sql and row_level_security.sql

class StoreRoles : public StoreOnServer {
 protected:
  void SetUp() override {
    StoreOnServer::SetUp();
    if (IsSkipped()) return;
    ASSERT_EQ(Run("roles.sql"), "");
    ASSERT_EQ(Run("roles.sql"), "");  // again
    for (const std::string user : {"reading", "writing", "elsewhere"}) {
      Sql("CREATE ROLE " + user + " LOGIN");
      Sql("GRANT slamdb_" + std::string(user == "reading" ? "reader" : "writer") + " TO " + user);
    }
  }
  std::string Run(const char* script) const {
    return Sql(FileBytes(std::string(SLAMDB_FIXTURES "/../schema/postgresql/") + script));
  }
};

TEST_F(StoreRoles, ReadersReadAndWritersWrite) {
  Store reader = Store::Open(UriOf("reading"));
  EXPECT_EQ(FirstDifference(reader.Load("a"), first_), "");
  EXPECT_EQ(reader.List().size(), 1U);
  EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(UriOf("reading")).Save("b", first_); }),
              HasSubstr("permission denied"));
  Store writer = Store::OpenForWriting(UriOf("writing"));
  EXPECT_EQ(writer.Save("a", second_).revision, 2U);
  writer.Tag("a", "t");
  writer.Untag("a", "t");
  writer.GiveUp({.keep = 1});
  writer.Save("b", first_);
  writer.Remove("b");
  EXPECT_THAT(SqlOn(UriOf("writing"), "DELETE FROM slamdb.history"), HasSubstr("permission denied"));
}

TEST_F(StoreRoles, RowLevelSecurityShowsEachItsProjects) {
  ASSERT_EQ(Run("row_level_security.sql"), "");
  ASSERT_EQ(Run("row_level_security.sql"), "");  // again
  Sql("CREATE ROLE warehouse NOLOGIN");
  Sql("GRANT warehouse TO writing");
  Sql("GRANT warehouse TO reading");
  Sql("ALTER ROLE writing SET slamdb.project = 'warehouse'");
  Store::OpenForWriting(UriOf("writing")).Save("secret", second_);
  EXPECT_THAT(Store::Open(UriOf("reading")).Names(), ElementsAre("a", "secret"));
  EXPECT_EQ(FirstDifference(Store::Open(UriOf("reading")).Load("secret"), second_), "");
  Store elsewhere = Store::OpenForWriting(UriOf("elsewhere"));
  EXPECT_THAT(elsewhere.Names(), ElementsAre("a"));
  EXPECT_THAT(ErrorOf([&] { elsewhere.Load("secret"); }), HasSubstr("no atlas named 'secret'"));
  EXPECT_EQ(elsewhere.Log("secret").size(), 0U);
  EXPECT_EQ(FirstDifference(elsewhere.Load("a"), first_), "");  // of no project: everybody's
  // A branch stays where it comes from, also without a project of its own.
  ASSERT_EQ(Sql("ALTER ROLE writing RESET slamdb.project"), "");
  Store::OpenForWriting(UriOf("writing")).Branch("secret", "branch");
  EXPECT_EQ(Sql("SELECT project FROM slamdb.atlas WHERE name = 'branch'"), "warehouse");
  EXPECT_THAT(elsewhere.Names(), ElementsAre("a"));
  const std::string other_rows = Sql("SELECT row FROM slamdb.atlas WHERE name = 'secret'");
  for (const char* table : {"keyframe", "map_point", "picture", "revision", "map", "keyframe_features"}) {
    const std::string of_other = detail::Concat("SELECT count(*) FROM slamdb.", table, " WHERE atlas = ", other_rows);
    EXPECT_NE(Sql(of_other), "0") << table;
    EXPECT_EQ(SqlOn(UriOf("elsewhere"), of_other), "0") << table;
  }
  for (const char* view : {"v_map_point", "v_keyframe", "v_revision"})
    EXPECT_EQ(
        SqlOn(UriOf("elsewhere"), detail::Concat("SELECT count(*) FROM slamdb.", view, " WHERE atlas = 'secret'")), "0")
        << view;
  EXPECT_THAT(SqlOn(UriOf("elsewhere"), "SELECT count(*) FROM slamdb.keyframe_0"), HasSubstr("permission denied"));
  EXPECT_THAT(ErrorOf([&] { elsewhere.Save("secret", first_); }), HasSubstr("of a project that you do not see"));
  // A name of the catalogue means the catalogue, whatever tables somebody makes.
  EXPECT_EQ(SqlOn(UriOf("elsewhere"),
                  "CREATE TEMPORARY TABLE pg_roles (rolname text, oid oid); INSERT INTO pg_roles VALUES ('warehouse', "
                  "'elsewhere'::regrole); SELECT count(*) FROM slamdb.keyframe WHERE atlas = " +
                      other_rows),
            "0");
  ASSERT_EQ(Run("roles.sql"), "");  // in any order
  ASSERT_EQ(Run("row_level_security.sql"), "");
  ASSERT_EQ(Run("roles.sql"), "");
  EXPECT_THAT(SqlOn(UriOf("elsewhere"), "SELECT count(*) FROM slamdb.keyframe_0"), HasSubstr("permission denied"));
  EXPECT_EQ(SqlOn(UriOf("elsewhere"), "SELECT count(*) FROM slamdb.keyframe WHERE atlas = " + other_rows), "0");
  // Also before there are these roles.
  for (const std::string role : {"slamdb_reader", "slamdb_writer"})
    ASSERT_EQ(Sql("ALTER ROLE " + role + " RENAME TO other_" + role), "");
  ASSERT_EQ(Run("row_level_security.sql"), "");
  for (const std::string role : {"slamdb_reader", "slamdb_writer"})
    ASSERT_EQ(Sql("ALTER ROLE other_" + role + " RENAME TO " + role), "");
  EXPECT_EQ(FirstDifference(Store::Open(uri_).Load("secret"), second_), "");
}

TEST_F(StoreOnServer, StatsTellOfTheWriteAheadLogWhoMayKnow) {
  EXPECT_GT(Store::Open(uri_).Stats().log_bytes, 1'000'000U);
  Sql("CREATE ROLE somebody LOGIN");
  Sql("GRANT USAGE ON SCHEMA slamdb TO somebody; GRANT SELECT ON ALL TABLES IN SCHEMA slamdb TO somebody");
  EXPECT_EQ(Store::Open(UriOf("somebody")).Stats().log_bytes, 0U);
}

TEST_F(StoreOnServer, AVersionThatNobodyMadeIsRefused) {
  for (const char* edit :
       {"UPDATE slamdb.store SET version = 0", "UPDATE slamdb.store SET version = -7", "DELETE FROM slamdb.store"}) {
    Sql(edit);
    for (const std::string& error :
         {ErrorOf([&] { Store::Open(uri_); }), ErrorOf([&] { Store::OpenForWriting(uri_); }),
          ErrorOf([&] { MigrateStore(uri_); }), ErrorOf([&] { static_cast<void>(Store::IsYetToBeMade(uri_)); })})
      EXPECT_THAT(error, HasSubstr("table store: says version")) << edit;
  }
  Sql("INSERT INTO slamdb.store (version, partitions) VALUES (1, 1)");
  ExpectFirst();
}

TEST_F(StoreOnServer, AMigrationWaitsForAnotherAsLongAsItIsTold) {
  postgresql::Connection other(uri_);
  other.Execute("SELECT pg_advisory_lock(x'534C4442'::bigint)");
  EXPECT_THAT(ErrorOf([&] { MigrateStore(uri_, {.lock_timeout = 0.05}); }),
              HasSubstr("another slamdb makes or migrates this store"));
  other.Execute("SELECT pg_advisory_unlock(x'534C4442'::bigint)");
  EXPECT_TRUE(MigrateStore(uri_, {.lock_timeout = 0.05}).steps.empty());
}

TEST_F(StoreOnServer, TakesAProvenanceOfAnyBytes) {
  Store::OpenForWriting(uri_).Save("a", second_, {.provenance = "convert \xff\xfe\x01.osa"});
  EXPECT_THAT(Store::Open(uri_).Log("a").back().provenance, HasSubstr("convert "));
}

TEST_F(StoreOnServer, OfADatabaseOfOthersSaysSo) {
  Sql("CREATE DATABASE latin ENCODING LATIN1 TEMPLATE template0 LOCALE 'C'");
  EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(Server().Uri("latin")); }), HasSubstr("the database is in LATIN1"));
  const std::string other = Server().Uri(Server().MakeDatabase());
  EXPECT_THAT(ErrorOf([&] { Store::Open(other); }), HasSubstr("holds no store yet"));
  SqlOn(other, "CREATE TABLE public.atlas (row integer)");
  Store::OpenForWriting(other).Save("a", first_);  // beside it, in a schema of its own
  EXPECT_EQ(FirstDifference(Store::Open(other).Load("a"), first_), "");
  Sql("UPDATE slamdb.store SET version = 99");
  EXPECT_THAT(ErrorOf([&] { Store::Open(uri_); }), HasSubstr("store version 99"));
  EXPECT_THAT(ErrorOf([&] { MigrateStore(uri_); }), HasSubstr("store version 99"));
  EXPECT_TRUE(MigrateStore(other).steps.empty());
}

TEST(StoreFailover, InTheMiddleOfASaveTheStandbyHasTheRevisionBeforeAndTakesTheSaveOver) {
  if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  const Atlas first = SoundAtlas(), second = OddAtlas();
  PostgresqlServer primary;
  const std::string database = primary.MakeDatabase();
  Store::OpenForWriting(primary.Uri(database)).Save("a", first);
  PostgresqlServer standby(PostgresqlServer::Follow{primary});
  EXPECT_EQ(FirstDifference(Store::Open(standby.Uri(database)).Load("a"), first), "");
  const std::string refused = ErrorOf([&] { Store::OpenForWriting(standby.Uri(database)).Save("a", second); });
  EXPECT_THAT(refused, HasSubstr("target_session_attrs"));
  // Both hosts, as a fleet's programs name them.
  const std::string both = detail::Concat("postgresql://", PostgresqlServer::kUser, "@/", database,
                                          "?host=", primary.folder(), ",", standby.folder(), "&port=", primary.port(),
                                          ",", standby.port(), "&target_session_attrs=read-write");
  SaveOptions options;
  options.before_commit = [&] { primary.Kill(); };
  EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(both).Save("a", second, options); }), HasSubstr("try again"));
  EXPECT_EQ(SqlOn(standby.Uri(database), "SELECT pg_promote()"), "t");
  EXPECT_EQ(FirstDifference(Store::Open(both).Load("a"), first), "");
  EXPECT_EQ(Store::OpenForWriting(both).Save("a", second).revision, 2U);
  EXPECT_EQ(FirstDifference(Store::Open(both).Load("a"), second), "");
}

}  // namespace
}  // namespace slamdb::store_test
