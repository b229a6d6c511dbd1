// SPDX-License-Identifier: BSD-3-Clause
// What every store does, whatever keeps it: a SQLite file, a database of a PostgreSQL server.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <thread>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/kind_of.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

enum class Keeper { kSqlite, kPostgresql };

Atlas ReadOsa(const std::string& path) {
  Notices notices;
  return ReadOrbslam3(path, {}, notices);
}

std::string NameOf(Keeper keeper) { return keeper == Keeper::kSqlite ? "Sqlite" : "Postgresql"; }

class StoreContract : public ::testing::TestWithParam<Keeper> {
 protected:
  void SetUp() override {
    if (GetParam() == Keeper::kPostgresql && !PostgresqlServer::IsInstalled())
      GTEST_SKIP() << "postgresql is not installed";
    path_ = NewPath();
  }
  // Of a store that is yet to be made.
  std::string NewPath() {
    if (GetParam() == Keeper::kSqlite) return folder_ / ("s" + std::to_string(++paths_) + ".db");
    PostgresqlServer& server = PostgresqlServer::Shared();
    return server.Uri(server.MakeDatabase());
  }
  Store Writer(double lock_timeout = 5) const {
    return Store::OpenForWriting(path_, {.sync = false, .lock_timeout = lock_timeout});
  }
  SaveReport Save(const Atlas& atlas, const std::string& name = "a", const SaveOptions& options = {}) const {
    return Writer().Save(name, atlas, options);
  }
  Atlas Load(const std::string& name = "a", const ReadOptions& options = {}) const {
    return Store::Open(path_).Load(name, options);
  }
  void ExpectHolds(const std::string& name, const Atlas& atlas) const {
    EXPECT_EQ(FirstDifference(Load(name), atlas), "") << name;
  }

  TemporaryFolder folder_;
  std::string path_;
  int paths_ = 0;
};

INSTANTIATE_TEST_SUITE_P(All, StoreContract, ::testing::Values(Keeper::kSqlite, Keeper::kPostgresql),
                         [](const auto& each) { return NameOf(each.param); });

// The atlas itself, as somebody goes on with it.
Atlas MovedOn(Atlas& atlas) {
  atlas.maps[0].points[0].position.x() += 1;
  return atlas;
}

TEST_P(StoreContract, KeepsEverythingThatIsHardToKeep) {
  const Atlas odd = OddAtlas();
  EXPECT_TRUE(Store::IsYetToBeMade(path_));
  const SaveReport report = Save(odd);
  EXPECT_FALSE(Store::IsYetToBeMade(path_));
  EXPECT_EQ(report.hash, HashOf(odd));
  EXPECT_EQ(report.revision, 1U);
  EXPECT_FALSE(report.replaced);
  ExpectHolds("a", odd);
  Save(Atlas{}, "empty");
  ExpectHolds("empty", Atlas{});
  EXPECT_THAT(Store::Open(path_).Names(), ElementsAre("a", "empty"));
}

TEST_P(StoreContract, KeepsRealAtlases) {
  std::vector<std::string> files{SLAMDB_FIXTURES "/session_small_a/session_small_a.osa",
                                 SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa"};
  if (const char* folder = std::getenv("SLAMDB_ATLASES"))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".osa") files.push_back(entry.path());
  for (const std::string& file : files) {
    const Atlas atlas = ReadOsa(file);
    Save(atlas, std::filesystem::path(file).stem());
    ExpectHolds(std::filesystem::path(file).stem(), atlas);
  }
}

TEST_P(StoreContract, RevisionsAreReadAgain) {
  Atlas atlas = SoundAtlas();
  std::vector<Atlas> saved;
  std::mt19937 random(7);
  for (int i = 0; i < 8; ++i) {
    Map& map = atlas.maps[static_cast<std::size_t>(i) % atlas.maps.size()];
    switch (i % 4) {
      case 0:
        map.points[random() % map.points.size()].position.x() += 1;
        break;
      case 1:
        map.points.erase(map.points.begin() + static_cast<std::ptrdiff_t>(random() % map.points.size()));
        break;
      case 2:
        std::swap(map.points.front(), map.points.back());
        break;
      case 3:
        map.keyframes.pop_back();
        break;
    }
    EXPECT_EQ(Save(atlas).revision, static_cast<std::uint64_t>(i) + 1);
    saved.push_back(atlas);
  }
  std::swap(atlas.maps[0], atlas.maps[1]);
  Save(atlas);
  saved.push_back(atlas);
  atlas.maps.pop_back();
  Save(atlas);
  saved.push_back(atlas);
  for (std::size_t i = 0; i < saved.size(); ++i) ExpectHolds("a@" + std::to_string(i + 1), saved[i]);
  EXPECT_THAT(ErrorOf([&] { Load("a@11"); }), HasSubstr("it has 1 to 10"));
  EXPECT_THAT(ErrorOf([&] { Load("b"); }), HasSubstr("no atlas named 'b'; it holds a"));
  EXPECT_EQ(FirstDifference(Load("a@-1"), saved[8]), "");
  EXPECT_EQ(FirstDifference(Load("a@{2999-12-31}"), saved[9]), "");
  EXPECT_THAT(ErrorOf([&] { Load("a@{1999-12-31}"); }), HasSubstr("none that is left was saved by then"));
}

TEST_P(StoreContract, WhatIsThereIsNotSavedAgain) {
  const Atlas atlas = SoundAtlas();
  Save(atlas);
  const SaveReport again = Save(atlas);
  EXPECT_TRUE(again.unchanged);
  EXPECT_EQ(again.revision, 1U);
  EXPECT_TRUE(Save(atlas, "a", {.overwrite = false, .keep_equal = true}).unchanged);
  EXPECT_THAT(ErrorOf([&] { Save(atlas, "a", {.overwrite = false}); }), HasSubstr("already"));
  EXPECT_THAT(ErrorOf([&] { Save(atlas, "a@2"); }), HasSubstr("stands for a revision"));
  EXPECT_THAT(ErrorOf([&] { Save(atlas, "a#b"); }), HasSubstr("the name of an atlas"));
  EXPECT_THAT(ErrorOf([&] { Save(OddAtlas(), "a", {.onto = 7}); }), HasSubstr("has revision 1 by now"));
  ExpectHolds("a", atlas);
}

TEST_P(StoreContract, TellsWhatASaveChanged) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  Map& map = atlas.maps[0];
  map.points[0].position.z() += 1;
  map.keyframes[0].camera_from_world.translation.x() += 1;
  const std::size_t gone = map.points.back().observations.size();
  map.points.pop_back();
  MapPoint added = map.points[1];
  added.id = MapPointId(987654);
  map.points.push_back(added);
  const SaveReport report = Save(atlas, "a", {.provenance = "a test"});
  EXPECT_EQ(report.map.points_moved, 1U);
  EXPECT_EQ(report.map.points_removed, 1U);
  EXPECT_EQ(report.map.points_added, 1U);
  EXPECT_EQ(report.map.keyframes_moved, 1U);
  EXPECT_EQ(report.map.keyframes_added + report.map.keyframes_removed, 0U);
  EXPECT_EQ(report.map.observations_added, added.observations.size());
  EXPECT_EQ(report.map.observations_removed, gone);
  const std::vector<HistoryEntry> log = Store::Open(path_).Log("a");
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[1].provenance, "a test");
  EXPECT_EQ(log[1].changes, report.map);
  EXPECT_EQ(log[1].revision, 2U);
  EXPECT_TRUE(log[0].readable);
  EXPECT_EQ(log[1].hash, HashOf(atlas));
  EXPECT_EQ(log[1].at.size(), std::string("2026-01-31T12:00:00Z").size());
}

TEST_P(StoreContract, TagsBranchesAndRestores) {
  const Atlas first = SoundAtlas();
  Atlas second = first;
  second.maps[0].points[0].position.x() += 1;
  Save(first);
  Save(second);
  Store store = Writer();
  store.Tag("a@1", "release");
  ExpectHolds("a@release", first);
  EXPECT_THAT(ErrorOf([&] { store.Tag("a@2", "release"); }), HasSubstr("already"));
  store.Branch("a@release", "robot7");
  ExpectHolds("robot7", first);
  Atlas other = first;
  other.maps[0].points[1].position.x() += 2;
  store.Save("robot7", other);
  EXPECT_EQ(store.CommonBase("a", "robot7"), (RevisionName{"a", 1, HashOf(first)}));
  EXPECT_EQ(store.Restore("a@1").revision, 3U);
  ExpectHolds("a", first);
  store.Untag("a", "release");
  EXPECT_THAT(ErrorOf([&] { store.Untag("a", "release"); }), HasSubstr("no tag 'release'"));
}

// A robot that takes what was merged as it is, and both go on: that is what they come from by then.
TEST_P(StoreContract, WhatIsTheSameIsTheBaseWhoeverSavedIt) {
  Atlas atlas = SoundAtlas();
  Save(atlas, "lab");
  Store store = Writer();
  store.Branch("lab", "robot");
  store.Save("robot", MovedOn(atlas));
  store.Save("lab", MovedOn(atlas), {.from = store.FindRevision("robot")});
  store.Save("robot", atlas);
  EXPECT_EQ(store.CommonBase("lab", "robot")->hash, HashOf(atlas));
  const std::uint64_t merged = HashOf(atlas);
  store.Save("lab", MovedOn(atlas));
  store.Save("robot", MovedOn(atlas));
  EXPECT_EQ(store.CommonBase("lab", "robot"), (RevisionName{"lab", 2, merged}));
  EXPECT_EQ(store.CommonBase("robot", "lab"), (RevisionName{"lab", 2, merged}));
  // Taken back and forth no base is lost.
  store.Save("robot", SoundAtlas());
  store.Restore("lab@1");
  EXPECT_EQ(store.CommonBase("lab", "robot")->hash, HashOf(SoundAtlas()));
}

// What was restored was made of what it was restored from, and not of what it took the place of; both stay.
TEST_P(StoreContract, WhatWasTakenBackIsNoBase) {
  Atlas atlas = SoundAtlas();
  Save(atlas, "lab");
  Store store = Writer();
  store.Save("lab", MovedOn(atlas));
  store.Branch("lab", "taken_back");
  store.Restore("lab@1");
  store.Branch("lab", "robot");
  store.Save("robot", MovedOn(atlas));
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(store.CommonBase("taken_back", "robot"), (RevisionName{"lab", 1, HashOf(SoundAtlas())}));
    EXPECT_EQ(store.CommonBase("lab", "taken_back"), (RevisionName{"lab", 1, HashOf(SoundAtlas())}));
    store.GiveUp({.keep = 1});
  }
  EXPECT_EQ(store.Log("lab").back().from->ToString(), "lab@1");
}

// A restored revision is one also in the branch that a sync made of it, and a merge of an earlier one is none.
TEST_P(StoreContract, RestoredIsWhatIsAgainWhatItWasMadeOf) {
  Atlas atlas = SoundAtlas();
  const Atlas first = atlas;
  Save(first, "lab");
  Store store = Writer();
  store.Save("lab", MovedOn(atlas));
  store.Branch("lab", "lab-of-robot");
  store.Save("lab-of-robot", first, {.from = RevisionName{"lab", 1, HashOf(first)}});
  store.Save("lab-of-robot", MovedOn(atlas));
  store.Save("lab", MovedOn(atlas));
  EXPECT_EQ(store.CommonBase("lab", "lab-of-robot")->ToString(), "lab@1");

  Save(first, "hall");
  store.Save("hall", MovedOn(atlas));
  store.Restore("hall@1");
  const Atlas line = MovedOn(atlas);
  store.Save("hall", line);
  store.Branch("hall", "robot");
  store.Save("hall", MovedOn(atlas), {.from = store.FindRevision("hall@2")});
  store.Save("hall", MovedOn(atlas));
  store.Save("robot", MovedOn(atlas));
  EXPECT_EQ(store.CommonBase("hall", "robot")->hash, HashOf(line));
}

// As of every night: what was taken back goes, and with it what that had been restored from.
TEST_P(StoreContract, OfWhatWasRestoredOftenTheLastStays) {
  Atlas atlas = SoundAtlas();
  Save(atlas, "lab");
  atlas.maps[0].points[0].position.x() += 1;
  Store store = Writer();
  store.Save("lab", atlas);
  for (int i = 1; i < 6; ++i) store.Restore("lab@" + std::to_string(i));
  store.GiveUp({.keep = 1});
  std::vector<std::uint64_t> numbers;
  for (const RevisionChain& chain : store.Chains({}))
    for (const RevisionChain::Link& link : chain.links) numbers.push_back(link.number);
  EXPECT_THAT(numbers, ElementsAre(7));
  ExpectHolds("lab", SoundAtlas());
}

// What was restored and went on was not made of what stays before it.
TEST_P(StoreContract, GivingUpWhatWasRestoredChangesNoBase) {
  Atlas atlas = SoundAtlas();
  Save(atlas, "lab");
  Store store = Writer();
  store.Save("lab", MovedOn(atlas));
  store.Branch("lab", "taken_back");
  store.Restore("lab@1");
  store.Save("lab", MovedOn(atlas));
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(store.CommonBase("lab", "taken_back"), (RevisionName{"lab", 1, HashOf(SoundAtlas())}));
    store.GiveUp({.keep = 1});
  }
  store.Remove("taken_back");
  store.GiveUp({.keep = 1});
  EXPECT_EQ(store.Chains({}).at(0).links.size(), 1U);
}

TEST_P(StoreContract, WhatAnAtlasIsMadeOfIsStillThere) {
  Save(SoundAtlas(), "lab");
  Save(OddAtlas(), "lab");
  Store store = Writer();
  const RevisionName given_up = store.FindRevision("lab@1");
  store.GiveUp({.keep = 1});
  EXPECT_EQ(KindOf([&] { store.Save("robot", SoundAtlas(), {.from = given_up}); }), ErrorKind::kNotFound);
  EXPECT_THAT(store.Names(), ElementsAre("lab"));
}

// As in a store to which `sync` brought a restored revision of what had been given up there.
TEST_P(StoreContract, WhatWasRestoredOfWhatIsGoneHasNoBase) {
  Atlas atlas = SoundAtlas();
  Save(atlas, "lab");
  Store store = Writer();
  const Atlas second = MovedOn(atlas);
  store.Save("lab", second);
  store.Save("lab", MovedOn(atlas));
  store.GiveUp({.keep = 1});
  store.Branch("lab", "robot");
  store.Save("lab", second,
             {.from = RevisionName{"lab", 2, HashOf(second)},
              .recorded = Recorded{.number = 4, .at = "2026-11-20T08:00:00Z", .who = "robot", .tool = "slamdb"}});
  store.Save("lab", MovedOn(atlas));
  EXPECT_EQ(store.CommonBase("lab", "robot"), std::nullopt);
}

TEST_P(StoreContract, ChainsTellOfWhatWasGivenUp) {
  Atlas atlas = SoundAtlas();
  std::vector<std::pair<std::uint64_t, std::uint64_t>> saved;
  Store store = Writer();
  store.Save("other", atlas);
  for (int i = 1; i <= 4; ++i) {
    const SaveReport report = store.Save("lab", MovedOn(atlas));
    saved.emplace_back(report.revision, report.hash);
  }
  store.Save("lab", atlas);  // no revision
  store.Tag("lab@2", "kept");
  const auto given_up = [&](bool asked) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> found;
    for (const RevisionChain& chain : store.Chains({.given_up = asked}))
      for (const RevisionChain::Link& link : chain.given_up) found.emplace_back(link.number, link.hash);
    return found;
  };
  EXPECT_THAT(given_up(true), IsEmpty());
  store.GiveUp({.keep = 1});
  EXPECT_THAT(given_up(true), ElementsAre(saved[0], saved[2]));
  EXPECT_THAT(given_up(false), IsEmpty());
  store.Remove("lab");
  store.Save("lab", atlas);
  EXPECT_THAT(given_up(true), IsEmpty());
}

// Of what is called by one name after the other, and of what others are copies of, nothing is a base.
TEST_P(StoreContract, OneContentAloneIsNoBase) {
  const Atlas hall = SoundAtlas(), corridor = OddAtlas();
  Store store = Writer();
  store.Save("today", corridor);
  store.Save("today", hall);
  store.Save("corridor", corridor);
  store.Save("hall", hall);
  for (const auto& [one, other] : {std::pair("hall", "corridor"), {"today", "corridor"}, {"hall", "today"}}) {
    EXPECT_EQ(store.CommonBase(one, other), std::nullopt) << one << other;
    EXPECT_EQ(store.CommonBase(other, one), std::nullopt) << one << other;
  }
}

// Whatever others have of it, and however they are called.
TEST_P(StoreContract, CopiesOfWhatIsBetweenChangeNoBase) {
  Atlas atlas = SoundAtlas();
  Store store = Writer();
  store.Save("lab", atlas);
  store.Branch("lab", "zrobot");
  const Atlas second = MovedOn(atlas);
  store.Save("backup", second);
  store.Save("lab", second);
  store.Branch("lab", "alpha");
  store.Save("alpha", SoundAtlas());
  store.Save("lab", MovedOn(atlas));
  store.Save("zrobot", MovedOn(atlas));
  EXPECT_EQ(store.CommonBase("lab", "zrobot"), (RevisionName{"lab", 1, HashOf(SoundAtlas())}));
  EXPECT_EQ(store.CommonBase("zrobot", "lab"), (RevisionName{"lab", 1, HashOf(SoundAtlas())}));
}

TEST_P(StoreContract, GivesUpNeitherWhatABranchComesFromNorForOneRevision) {
  const Atlas first = SoundAtlas();
  Atlas atlas = first;
  Save(first);
  Store store = Writer();
  store.Branch("a", "robot");
  for (int i = 0; i < 2; ++i) {
    atlas.maps[0].points[0].position.x() += 1;
    store.Save("a", atlas);
    store.Save("robot", atlas);
  }
  EXPECT_THAT(ErrorOf([&] { store.GiveUp({.keep = 1}, "a@2"); }), HasSubstr("'a@2' is one revision"));
  EXPECT_THAT(ErrorOf([&] { store.GiveUp({.keep = 1}, "nobody"); }), HasSubstr("no atlas named 'nobody'"));
  store.GiveUp({.keep = 1});
  ExpectHolds("a@1", first);
  ExpectHolds("robot@1", first);
  ExpectHolds("a", atlas);
  EXPECT_THAT(ErrorOf([&] { store.Load("a@2"); }), HasSubstr("no revision '2'"));
}

TEST_P(StoreContract, GivesRevisionsUp) {
  Atlas atlas = SoundAtlas();
  std::vector<Atlas> saved;
  for (int i = 0; i < 6; ++i) {
    atlas.maps[0].points[static_cast<std::size_t>(i)].position.x() += 1;
    atlas.maps[0].keyframes[0].features.keypoints[static_cast<std::size_t>(i)].x += 1;
    Save(atlas);
    saved.push_back(atlas);
  }
  Store store = Writer();
  store.Tag("a@2", "kept");
  const GiveUpReport planned = store.GiveUp({.keep = 2, .dry_run = true});
  EXPECT_THAT(planned.atlases[0].revisions, ElementsAre(1, 3, 4));
  ExpectHolds("a@1", saved[0]);
  const GiveUpReport report = store.GiveUp({.keep = 2});
  ASSERT_EQ(report.atlases.size(), 1U);
  EXPECT_THAT(report.atlases[0].revisions, ElementsAre(1, 3, 4));
  EXPECT_EQ(report.pictures, 3U);
  ExpectHolds("a@2", saved[1]);
  ExpectHolds("a@5", saved[4]);
  ExpectHolds("a", saved[5]);
  EXPECT_THAT(ErrorOf([&] { Load("a@3"); }), HasSubstr("it has 2, 5, 6"));
}

TEST_P(StoreContract, WhatAnAtlasWasMadeOfMakesARevisionOnce) {
  const Atlas atlas = SoundAtlas();
  Atlas other = atlas;
  other.maps[0].points[0].position.x() += 1;
  Save(atlas);
  Save(other, "b");
  const RevisionName source = Writer().FindRevision("b");
  const SaveReport merged = Writer().Save("a", atlas, {.from = source});
  EXPECT_FALSE(merged.unchanged);
  EXPECT_EQ(merged.revision, 2U);
  EXPECT_EQ(Writer().Log("a").back().from, source);
  ExpectHolds("a", atlas);
  ExpectHolds("a@1", atlas);
  EXPECT_TRUE(Writer().Save("a", atlas, {.from = source}).unchanged);
  EXPECT_TRUE(Writer().Save("a", atlas).unchanged);
}

TEST_P(StoreContract, RemovesAnAtlasWithAllItsRevisions) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points.pop_back();
  Save(atlas);
  Save(OddAtlas(), "b");
  Writer().Remove("a");
  EXPECT_THAT(Store::Open(path_).Names(), ElementsAre("b"));
  ExpectHolds("b", OddAtlas());
  EXPECT_EQ(Store::Open(path_).Log("a").back().action, "remove");
  EXPECT_THAT(ErrorOf([&] { Writer().Remove("a"); }), HasSubstr("no atlas named 'a'"));
  EXPECT_EQ(Save(atlas).revision, 1U);
  ExpectHolds("a", atlas);
}

TEST_P(StoreContract, FindsAtlasesAsTheModelDoes) {
  const std::vector<std::pair<std::string, Atlas>> atlases{
      {"sound", SoundAtlas()},
      {"odd", OddAtlas()},
      {"real", ReadOsa(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa")},
      {"empty", Atlas{}}};
  for (const auto& [name, atlas] : atlases) Save(atlas, name);
  Store store = Store::Open(path_);
  std::vector<MapQuery> queries(1);
  for (const auto& [name, atlas] : atlases)
    for (const Map& map : atlas.maps) {
      if (map.keyframes.empty() || map.points.empty()) continue;
      MapQuery query;
      query.times = MapQuery::Times{map.keyframes[0].timestamp - 0.5, map.keyframes[0].timestamp + 0.5};
      queries.push_back(query);
      query = {};
      query.keyframes = MapQuery::Ids{map.keyframes.back().id.value(), map.keyframes.back().id.value()};
      queries.push_back(query);
      query.keyframes = MapQuery::Ids{std::uint64_t{1} << 63, ~std::uint64_t{0}};
      queries.push_back(query);
      query = {};
      query.near = MapQuery::Ball{map.points[0].position.cast<double>(), 0.1};
      queries.push_back(query);
      query.near->radius = 0;
      queries.push_back(query);
      query.times = MapQuery::Times{0, 1e12};
      queries.push_back(query);
    }
  for (std::size_t i = 0; i < queries.size(); ++i) {
    std::vector<std::string> expected;
    for (const auto& [name, atlas] : atlases)
      if (Matches(atlas, queries[i])) expected.push_back(name);
    std::ranges::sort(expected);
    EXPECT_EQ(store.Find(queries[i]), expected) << "query " << i;
  }
}

TEST_P(StoreContract, FindsAtlasesByWhatItTellsOfThem) {
  const Atlas small = SynthesizeAtlas({.keyframes = 4, .points = 40, .features = 60});
  const Atlas large = SynthesizeAtlas({.keyframes = 9, .points = 200, .features = 200, .seed = 2});
  const auto save = [&](const std::string& name, const Atlas& atlas, std::uint64_t number, const std::string& who,
                        const std::string& provenance) {
    Save(atlas, name,
         {.provenance = provenance,
          .recorded = Recorded{.number = number, .at = "2026-11-20T08:00:00Z", .who = who, .tool = "slamdb 0"}});
  };
  save("a", small, 1, "anna@robot7", "convert monday.osa");
  save("a", large, 2, "root@station", "merge lab [1] 100%_");
  save("b", large, 1, "root@robot70", "convert tuesday.osa");
  save("c", small, 1, "robot7@lab", "");
  Store store = Writer();
  store.Tag("a@1", "release");
  store.Tag("b", "release-2");

  const auto found = [&](const AtlasQuery& query) { return store.Find(query); };
  using enum AtlasQuery::Number;
  EXPECT_THAT(found({}), ElementsAre("a", "b", "c"));
  EXPECT_THAT(found({.who = "robot7"}), ElementsAre("a", "c")) << "host or user, of any revision";
  EXPECT_THAT(found({.who = "robot7*"}), ElementsAre("a", "b", "c"));
  EXPECT_THAT(found({.who = "robot??"}), ElementsAre("b"));
  EXPECT_THAT(found({.who = "*@robot7"}), ElementsAre("a"));
  EXPECT_THAT(found({.who = "Robot7"}), IsEmpty());
  EXPECT_THAT(found({.provenance = "convert"}), ElementsAre("a", "b")) << "a part";
  EXPECT_THAT(found({.provenance = "convert m*"}), ElementsAre("a"));
  EXPECT_THAT(found({.provenance = "[1] 100%_"}), ElementsAre("a")) << "letters that mean something to databases";
  EXPECT_THAT(found({.provenance = "[0-9]"}), IsEmpty());
  EXPECT_THAT(found({.provenance = "1__%"}), IsEmpty());
  EXPECT_THAT(found({.provenance = "' OR 1 = 1 --"}), IsEmpty());
  EXPECT_THAT(found({.tag = "release"}), ElementsAre("a"));
  EXPECT_THAT(found({.tag = "release*"}), ElementsAre("a", "b"));
  EXPECT_THAT(found({.who = "anna", .tag = "release"}), ElementsAre("a"));
  EXPECT_THAT(found({.who = "root", .tag = "release"}), IsEmpty()) << "another revision";
  EXPECT_THAT(found({.ranges = {{kKeyframes, 9}}}), ElementsAre("a", "b"));
  EXPECT_THAT(found({.ranges = {{kKeyframes, 4, 4}}}), ElementsAre("c"));
  EXPECT_THAT(found({.ranges = {{.number = kPoints, .high = 39.5}}}), IsEmpty());
  EXPECT_THAT(found({.ranges = {{kRevision, 2}, {kMaps, 1, 1}}}), ElementsAre("a"));
  EXPECT_THAT(found({.ranges = {{kRevision, 2}}, .who = "robot70"}), IsEmpty());
  const double length = store.List()[2].trajectory_length;
  EXPECT_THAT(found({.ranges = {{kLength, length, length}}}), ElementsAre("c"));
  for (const auto number :
       {kMaps, kKeyframes, kPoints, kObservations, kLandmarks, kLength, kDuration, kBytes, kRevision})
    EXPECT_THAT(found({.ranges = {{number, 0}}}), ElementsAre("a", "b", "c"));
}

// Their differences are no numbers.
TEST_P(StoreContract, FindsWhatLiesAtTheEndsOfNumbers) {
  constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::denorm_min(),
                   kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> ends{-kMost, -1.7e308, -1, -kLeast, 0, kLeast, 1, 1.7e308, kMost};
  std::vector<std::pair<std::string, Atlas>> atlases;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Atlas atlas = SoundAtlas();
    for (Map& map : atlas.maps)
      for (std::size_t k = 0; k < map.keyframes.size(); ++k)
        map.keyframes[k].timestamp = k % 2 == 0 ? ends[i] : ends[ends.size() - 1 - i];
    for (Map& map : atlas.maps)
      for (std::size_t k = 0; k < map.points.size(); ++k)
        map.points[k].position.setConstant(static_cast<float>(std::clamp(ends[i], -3.4e38, 3.4e38)));
    Save(atlas, "a" + std::to_string(i));
    ExpectHolds("a" + std::to_string(i), atlas);
    atlases.emplace_back("a" + std::to_string(i), std::move(atlas));
  }
  std::vector<MapQuery> queries;
  std::vector<double> asked = ends;
  asked.insert(asked.end(), {-kInfinity, kInfinity, kNan});
  for (const double begin : asked)
    for (const double end : asked)
      if (begin <= end) queries.emplace_back().times = MapQuery::Times{begin, end};
  for (const double center : {-1.0, 0.0, 1.0, 1e30, 3.4e38})
    for (const double radius : {0.0, 1.0, 1e30, 1e100})
      queries.emplace_back().near = MapQuery::Ball{Eigen::Vector3d::Constant(center), radius};
  Store store = Store::Open(path_);
  for (const MapQuery& query : queries) {
    std::vector<std::string> expected;
    for (const auto& [name, atlas] : atlases)
      if (Matches(atlas, query)) expected.push_back(name);
    EXPECT_EQ(store.Find(query), expected) << (query.times ? query.times->begin : query.near->center.x()) << " "
                                           << (query.times ? query.times->end : query.near->radius);
  }
}

TEST_P(StoreContract, ListsAsTheAtlasIs) {
  const Atlas atlas = ReadOsa(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  Save(atlas);
  const std::vector<StoredAtlas> list = Store::Open(path_).List();
  ASSERT_EQ(list.size(), 1U);
  const AtlasSummary summary = Summarize(atlas);
  EXPECT_EQ(list[0].name, "a");
  EXPECT_EQ(list[0].problem, "");
  EXPECT_EQ(list[0].hash, HashOf(atlas));
  EXPECT_EQ(list[0].keyframes, summary.keyframes);
  EXPECT_EQ(list[0].points, summary.points);
  EXPECT_EQ(list[0].observations, summary.observations);
  EXPECT_EQ(list[0].sensors, summary.sensors);
  EXPECT_EQ(list[0].trajectory_length, summary.trajectory_length);
  EXPECT_EQ(list[0].begin_time, summary.begin_time);
  EXPECT_GT(list[0].bytes, 100'000U);
  EXPECT_GT(Store::Open(path_).Stats().file_bytes, list[0].bytes / 2);
}

TEST_P(StoreContract, LoadsParts) {
  const Atlas atlas = ReadOsa(SLAMDB_FIXTURES "/session_small_b/session_small_b.osa");
  Save(atlas);
  const Map& map = atlas.maps[0];
  ReadOptions options;
  options.selection.map = map.id;
  options.selection.first_keyframe = map.keyframes[2].id.value();
  options.selection.last_keyframe = map.keyframes[2].id.value() + 3;
  options.selection.box = Eigen::AlignedBox3f(Eigen::Vector3f::Constant(-1), Eigen::Vector3f::Constant(1));
  const Atlas part = Load("a", options);
  ASSERT_EQ(part.maps.size(), 1U);
  std::vector<KeyFrameId> expected;
  for (const KeyFrame& keyframe : map.keyframes)
    if (options.selection.Has(keyframe)) expected.push_back(keyframe.id);
  std::vector<KeyFrameId> found;
  for (const KeyFrame& keyframe : part.maps[0].keyframes) {
    found.push_back(keyframe.id);
    EXPECT_FALSE(keyframe.features.descriptors.empty());
  }
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 0U);
  EXPECT_EQ(part.maps[0].points.size(),
            static_cast<std::size_t>(std::ranges::count_if(
                map.points, [&](const MapPoint& point) { return options.selection.Has(point); })));
  ReadOptions no_features;
  no_features.features = FeatureColumns::kNone;
  EXPECT_EQ(Load("a", no_features).maps[0].keyframes.size(), map.keyframes.size());
}

TEST_P(StoreContract, KnowsPlacesByPictures) {
  const Atlas atlas = ReadOsa(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  Save(atlas, "here");
  Save(ReadOsa(SLAMDB_FIXTURES "/session_small_b/session_small_b.osa"), "there");
  const KeyFrame& keyframe = atlas.maps[0].keyframes[3];
  const std::vector<Descriptor> picture(keyframe.features.descriptors.begin(), keyframe.features.descriptors.end());
  const std::span<const Descriptor> pictures[] = {picture};
  const StoredPlaces places = Store::Open(path_).PlacesLike(pictures);
  ASSERT_FALSE(places.by_picture[0].empty());
  EXPECT_EQ(places.by_picture[0][0].atlas, "here");
  EXPECT_THAT(places.unknown, IsEmpty());
  EXPECT_NEAR(static_cast<double>(places.by_picture[0][0].keyframe.value()), static_cast<double>(keyframe.id.value()),
              8);
}

TEST_P(StoreContract, OfBranchesOneIsLookedAtFirst) {
  const Atlas atlas = ReadOsa(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  const KeyFrame& keyframe = atlas.maps[0].keyframes[3];
  const std::vector<Descriptor> picture(keyframe.features.descriptors.begin(), keyframe.features.descriptors.end());
  const std::span<const Descriptor> pictures[] = {picture};
  const auto atlases = [&](std::size_t places) {
    const StoredPlaces found = Store::Open(path_).PlacesLike(pictures, {.places = places, .of_map = 1, .faint = true});
    std::set<std::string> names;
    for (const StoredPlace& place : found.by_picture[0]) names.insert(place.atlas);
    return names;
  };
  Save(ReadOsa(SLAMDB_FIXTURES "/session_small_b/session_small_b.osa"), "there");
  for (const char* name : {"robot3", "robot1", "robot2"}) Save(atlas, name);
  EXPECT_THAT(atlases(1), ElementsAre("robot1")) << "of what is the same the first by name, whoever was saved first";
  EXPECT_THAT(atlases(2), ElementsAre("robot1", "there"));
  EXPECT_THAT(atlases(4), ElementsAre("robot1", "robot2", "robot3", "there"));
}

TEST_P(StoreContract, OfTwoWhoSaveOneAtlasOneWaits) {
  const Atlas atlas = SoundAtlas();
  Save(atlas);
  Atlas other = atlas;
  other.maps[0].points[0].position.x() += 1;
  SaveOptions options;
  options.before_commit = [&] {
    EXPECT_THAT(ErrorOf([&] { Writer(0.05).Save("a", OddAtlas()); }), HasSubstr("locked by slamdb"));
    ExpectHolds("a", atlas);  // readers see what was there
  };
  Save(other, "a", options);
  ExpectHolds("a", other);
  options.before_commit = [] { throw std::runtime_error("no"); };
  EXPECT_THROW(Save(OddAtlas(), "a", options), std::runtime_error);
  ExpectHolds("a", other);
  EXPECT_THROW(Save(OddAtlas(), "new", options), std::runtime_error);
  EXPECT_THAT(Store::Open(path_).Names(), ElementsAre("a"));
}

TEST_P(StoreContract, NoUpdateIsLostOfMany) {
  Save(SoundAtlas(), "shared");
  constexpr int kWriters = 4, kSaves = 5;
  std::atomic<int> revisions{0};
  std::vector<std::thread> writers;
  for (int w = 0; w < kWriters; ++w)
    writers.emplace_back([&, w] {
      Store store = Writer(60);
      for (int s = 0; s < kSaves; ++s) {
        Atlas atlas = SoundAtlas();
        atlas.maps[0].points[0].position = {static_cast<float>(w), static_cast<float>(s), 1};
        store.Save("own" + std::to_string(w), atlas);
        if (!store.Save("shared", atlas).unchanged) ++revisions;
      }
    });
  for (std::thread& writer : writers) writer.join();
  Store store = Store::Open(path_);
  EXPECT_EQ(store.FindRevision("shared").number, static_cast<std::uint64_t>(revisions) + 1);
  for (int w = 0; w < kWriters; ++w) {
    const Atlas atlas = store.Load("own" + std::to_string(w));
    EXPECT_EQ(atlas.maps[0].points[0].position, Eigen::Vector3f(static_cast<float>(w), kSaves - 1, 1));
  }
  for (std::uint64_t number = 1; number <= store.FindRevision("shared").number; ++number)
    EXPECT_NO_THROW(store.Load("shared@" + std::to_string(number)));
}

TEST_P(StoreContract, AnAtlasThatMovesKeepsItsHashAndItsBytes) {
  if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  const Atlas atlas = ReadOsa(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  const std::uint64_t hash = Save(atlas).hash;
  PostgresqlServer& server = PostgresqlServer::Shared();
  const std::string other =
      GetParam() == Keeper::kPostgresql ? folder_ / "other.db" : server.Uri(server.MakeDatabase());
  EXPECT_EQ(Store::OpenForWriting(other).Save("a", Load()).hash, hash);
  EXPECT_EQ(FirstDifference(Store::Open(other).Load("a"), atlas), "");
}

TEST_P(StoreContract, RefusesWhatAReaderMayNotDoAndWhatMeansNothing) {
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }),
              ::testing::AnyOf(HasSubstr("no such file"), HasSubstr("holds no store yet")));
  Save(SoundAtlas());
  Store reader = Store::Open(path_);
  EXPECT_THAT(ErrorOf([&] { reader.Save("b", Atlas{}); }), HasSubstr("opened for reading"));
  EXPECT_THAT(ErrorOf([&] { reader.Tag("a", "t"); }), HasSubstr("opened for reading"));
  EXPECT_THAT(ErrorOf([&] { Writer().Restore("a"); }), HasSubstr("is the newest"));
  EXPECT_THAT(ErrorOf([&] { Writer().Tag("a", "3"); }), HasSubstr("no name for a revision"));
  EXPECT_EQ(reader.OnlyName(), "a");
}

}  // namespace
}  // namespace slamdb::store_test
