// SPDX-License-Identifier: BSD-3-Clause
// Stores come to hold the same: files and databases of servers, in every pair.
#include "slamdb/many/sync.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <set>

#include "slamdb/formats/postgresql/fleet.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"
#include "tests/support/postgresql_server.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

enum class Keeper { kFile, kServer };

Atlas Made(std::uint64_t seed) { return SynthesizeAtlas({.keyframes = 4, .points = 40, .features = 60, .seed = seed}); }

// As a robot goes on: something moves, something goes, something is seen that was not.
void Change(Atlas& atlas, int step) {
  Map& map = atlas.maps.front();
  map.points[static_cast<std::size_t>(step) % map.points.size()].position.x() += 1;
  if (step % 2 == 0) map.points.pop_back();
  if (step % 3 == 0) {
    KeyFrame& keyframe = map.keyframes[static_cast<std::size_t>(step) % map.keyframes.size()];
    for (MapPointId& point : keyframe.features.map_points) point = MapPointId();
  }
}

// What tells a revision of a log, whatever store has it.
std::string Told(const HistoryEntry& entry) {
  std::string text = std::to_string(entry.revision) + " " + std::to_string(entry.hash) + " " + entry.at + " " +
                     entry.who + " " + entry.tool + " '" + entry.provenance + "'";
  if (entry.from) text += " from " + entry.from->ToString() + " " + std::to_string(entry.from->hash);
  for (const std::string& tag : entry.tags) text += " #" + tag;
  return text;
}
// Of the revisions that can be read.
std::vector<std::string> LogOf(const std::string& store, const std::string& name) {
  std::vector<std::string> told;
  for (const HistoryEntry& entry : Store::Open(store).Log(name))
    if (entry.readable) told.push_back(Told(entry));
  return told;
}

// `copied a: 2 3 to first`.
std::vector<std::string> Told(const SyncReport& report) {
  std::vector<std::string> told;
  for (const SyncedAtlas& atlas : report.atlases) {
    std::string& text = told.emplace_back(std::string(NameOf(atlas.result)) + " " + atlas.name);
    for (const std::uint64_t revision : atlas.revisions) text += " " + std::to_string(revision);
    if (!atlas.revisions.empty()) text += atlas.to_first ? " to first" : " to second";
    if (!atlas.branch.empty()) text += " as " + atlas.branch;
    for (const SyncedAtlas::Tag& tag : atlas.tags) text += " #" + tag.tag + (tag.to_first ? " to first" : " to second");
  }
  return told;
}

struct Pair {
  Keeper first, second;
};

class SyncTest : public ::testing::TestWithParam<Pair> {
 protected:
  void SetUp() override {
    const auto [first, second] = GetParam();
    if ((first == Keeper::kServer || second == Keeper::kServer) && !PostgresqlServer::IsInstalled())
      GTEST_SKIP() << "postgresql is not installed";
    first_ = NewPath(first);
    second_ = NewPath(second);
  }
  std::string NewPath(Keeper keeper) {
    if (keeper == Keeper::kFile) return folder_ / ("s" + std::to_string(++paths_) + ".db");
    PostgresqlServer& server = PostgresqlServer::Shared();
    return server.Uri(server.MakeDatabase());
  }
  static Store Writer(const std::string& path) { return Store::OpenForWriting(path, {.sync = false}); }
  static SaveReport Save(const std::string& path, const std::string& name, const Atlas& atlas,
                         const SaveOptions& options = {}) {
    return Writer(path).Save(name, atlas, options);
  }
  // Revisions of one atlas that goes on; returns the last.
  static Atlas SaveSome(const std::string& path, const std::string& name, int count, std::uint64_t seed = 1) {
    Atlas atlas = Made(seed);
    for (int i = 1; i <= count; ++i) {
      if (i > 1) Change(atlas, i);
      Save(path, name, atlas, {.provenance = "step " + std::to_string(i)});
    }
    return atlas;
  }
  SyncReport Sync(SyncOptions options = {}) const {
    options.sync = false;
    return SyncStores(first_, second_, options);
  }
  // Every revision that either has is in the other, with the same content and log.
  void ExpectSame(const std::string& name) const {
    const std::vector<std::string> log = LogOf(first_, name);
    EXPECT_FALSE(log.empty()) << name;
    EXPECT_EQ(LogOf(second_, name), log) << name;
    for (const RevisionChain& chain : Store::Open(first_).Chains({.names = {name}}))
      for (const RevisionChain::Link& link : chain.links) {
        const RevisionName revision{name, link.number, link.hash};
        const Atlas atlas = Store::Open(first_).LoadOnto(revision, {});
        EXPECT_EQ(HashOf(atlas), link.hash);
        EXPECT_EQ(FirstDifference(Store::Open(second_).LoadOnto(revision, {}), atlas), "") << revision.ToString();
      }
  }
  void ExpectNothingToDo(const std::vector<std::string>& told = {}) const {
    const SyncReport report = Sync();
    EXPECT_EQ(Told(report), told);
    EXPECT_EQ(report.same, Store::Open(first_).Names().size());
  }

  TemporaryFolder folder_;
  std::string first_, second_;
  int paths_ = 0;
};

std::string NameOfPair(const ::testing::TestParamInfo<Pair>& each) {
  const auto name = [](Keeper keeper) { return std::string(keeper == Keeper::kFile ? "File" : "Server"); };
  return name(each.param.first) + "And" + name(each.param.second);
}

INSTANTIATE_TEST_SUITE_P(All, SyncTest,
                         ::testing::Values(Pair{Keeper::kFile, Keeper::kFile}, Pair{Keeper::kFile, Keeper::kServer},
                                           Pair{Keeper::kServer, Keeper::kFile},
                                           Pair{Keeper::kServer, Keeper::kServer}),
                         NameOfPair);

TEST_P(SyncTest, BothComeToHaveWhatEitherHas) {
  SaveSome(first_, "a", 4);
  SaveSome(second_, "b", 3, 2);
  Save(second_, "empty", Atlas{});
  EXPECT_THAT(Told(Sync()),
              ElementsAre("copied a 1 2 3 4 to second", "copied b 1 2 3 to first", "copied empty 1 to first"));
  for (const char* name : {"a", "b", "empty"}) ExpectSame(name);
  EXPECT_EQ(Store::Open(first_).Names(), Store::Open(second_).Names());
  ExpectNothingToDo();
}

TEST_P(SyncTest, OneGoesOnBehindTheOther) {
  Atlas atlas = SaveSome(first_, "a", 2);
  Sync();
  for (int i = 3; i < 7; ++i) {
    Change(atlas, i);
    Save(second_, "a", atlas, {.provenance = "on " + std::to_string(i)});
  }
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 3 4 5 6 to first"));
  ExpectSame("a");
  Change(atlas, 7);
  EXPECT_EQ(Save(first_, "a", atlas).revision, 7U);
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 7 to second"));
  ExpectSame("a");
}

TEST_P(SyncTest, WhatIsCopiedIsTheNewestAndCanBeGoneOnWith) {
  Atlas atlas = SaveSome(first_, "a", 3);
  Sync();
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load("a"), atlas), "");
  EXPECT_EQ(Store::Open(second_).List()[0].saved_at, Store::Open(first_).List()[0].saved_at);
  EXPECT_EQ(Store::Open(second_).List()[0].revision, 3U);
  Change(atlas, 9);
  EXPECT_EQ(Save(second_, "a", atlas).revision, 4U);
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load("a@2"), Store::Open(first_).Load("a@2")), "");
}

TEST_P(SyncTest, TagsAndWhatRevisionsWereMadeOfGoAlong) {
  Atlas atlas = SaveSome(first_, "a", 2);
  Writer(first_).Branch("a@1", "b");
  Change(atlas, 5);
  Save(first_, "a", atlas, {.from = Store::Open(first_).FindRevision("b")});
  Writer(first_).Tag("a@1", "start");
  Sync();
  ExpectSame("a");
  ExpectSame("b");
  EXPECT_EQ(Store::Open(second_).CommonBase("a", "b"), Store::Open(first_).CommonBase("a", "b"));
  Writer(second_).Tag("a@2", "release");
  Writer(first_).Tag("a", "now");
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a #now to second #release to first"));
  ExpectSame("a");
  ExpectNothingToDo();
}

TEST_P(SyncTest, ATagOfTwoRevisionsIsAConflict) {
  SaveSome(first_, "a", 3);
  Sync();
  Writer(first_).Tag("a@1", "release");
  Writer(second_).Tag("a@2", "release");
  const SyncReport report = Sync();
  ASSERT_THAT(report.atlases, SizeIs(1));
  ASSERT_THAT(report.atlases[0].conflicts, SizeIs(1));
  EXPECT_EQ(report.atlases[0].conflicts[0].first, 1U);
  EXPECT_EQ(report.atlases[0].conflicts[0].second, 2U);
  EXPECT_EQ(report.Conflicts(), 1U);
  EXPECT_EQ(Store::Open(first_).FindRevision("a@release").number, 1U);
  EXPECT_EQ(Store::Open(second_).FindRevision("a@release").number, 2U);
}

TEST_P(SyncTest, NumbersStayWhereRevisionsWereGivenUp) {
  Atlas atlas = SaveSome(first_, "a", 6);
  Writer(first_).Tag("a@3", "kept");
  Writer(first_).GiveUp({.keep = 2});
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 3 5 6 to second #kept to second"));
  ExpectSame("a");
  // What is given up on one side stays on the other, and does not come back.
  Writer(second_).GiveUp({.keep = 1});
  Change(atlas, 8);
  Save(second_, "a", atlas);
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 7 to first"));
  EXPECT_THAT(LogOf(first_, "a"), SizeIs(4));
  ExpectNothingToDo();
}

// Each as the first and as the second, `sync` having been run before.
class GaveUpTest : public SyncTest {
 protected:
  // Saves revisions `begin` to `end` of an atlas that goes on, each by a step of `by` more.
  static void GoOn(const std::string& path, Atlas& atlas, int begin, int end, int by = 0) {
    for (int i = begin; i <= end; ++i) {
      Change(atlas, i + by);
      EXPECT_EQ(Save(path, "a", atlas).revision, static_cast<std::uint64_t>(i));
    }
  }
  // Of the other store: what it lacks comes to it, and both are the same then.
  void ExpectFollows(const std::string& follower, const std::string& revisions) const {
    const std::string where = follower == first_ ? " to first" : " to second";
    EXPECT_THAT(Told(Sync()), ElementsAre("copied a " + revisions + where));
    EXPECT_EQ(Store::Open(first_).List()[0].hash, Store::Open(second_).List()[0].hash);
    ExpectNothingToDo();
  }
  std::vector<std::pair<std::string, std::string>> BothWays() const { return {{first_, second_}, {second_, first_}}; }
  void StartAnew() {
    for (const std::string& path : {first_, second_}) Writer(path).Remove("a");
  }
};
INSTANTIATE_TEST_SUITE_P(All, GaveUpTest,
                         ::testing::Values(Pair{Keeper::kFile, Keeper::kFile}, Pair{Keeper::kFile, Keeper::kServer},
                                           Pair{Keeper::kServer, Keeper::kServer}),
                         NameOfPair);

TEST_P(GaveUpTest, WhatTheOtherHasAsItsNewest) {
  for (const auto& [behind, ahead] : BothWays()) {
    Atlas atlas = SaveSome(behind, "a", 1);
    Sync();
    GoOn(ahead, atlas, 2, 5);
    Writer(ahead).GiveUp({.keep = 3});
    ExpectFollows(behind, "3 4 5");
    GoOn(behind, atlas, 6, 8);
    Writer(behind).GiveUp({.keep = 1});
    ExpectFollows(ahead, "8");
    StartAnew();
  }
}

TEST_P(GaveUpTest, WhatWasBeforeARestore) {
  for (const auto& [behind, ahead] : BothWays()) {
    Atlas atlas = SaveSome(behind, "a", 3);
    Sync();
    Writer(ahead).Restore("a@2");
    Writer(ahead).GiveUp({.keep = 1});
    ExpectFollows(behind, "4");
    EXPECT_EQ(Store::Open(behind).FindRevision("a").hash, Store::Open(behind).FindRevision("a@2").hash);
    StartAnew();
  }
}

// By its content alone it would look like what the other has before its newest.
TEST_P(GaveUpTest, ARestoredOneStaysTheNewest) {
  for (const auto& [behind, ahead] : BothWays()) {
    Atlas atlas = SaveSome(behind, "a", 3);
    Sync();
    const Atlas second = Store::Open(ahead).Load("a@2");
    EXPECT_EQ(Save(ahead, "a", second).revision, 4U);
    Writer(ahead).GiveUp({.keep = 1});
    ExpectFollows(behind, "4");
    EXPECT_EQ(FirstDifference(Store::Open(ahead).Load("a"), second), "");
    StartAnew();
  }
}

TEST_P(GaveUpTest, AndBothWentOn) {
  for (const auto& [one, other] : BothWays()) {
    Atlas ours = SaveSome(one, "a", 1), theirs = ours;
    Sync();
    GoOn(one, ours, 2, 4);
    GoOn(other, theirs, 2, 4, 10);
    Writer(one).GiveUp({.keep = 2});
    EXPECT_THAT(Told(Sync()), ElementsAre("diverged a"));
    Writer(other).GiveUp({.keep = 1});
    EXPECT_THAT(Told(Sync()), ElementsAre("diverged a"));
    EXPECT_EQ(FirstDifference(Store::Open(one).Load("a"), ours), "");
    EXPECT_EQ(FirstDifference(Store::Open(other).Load("a"), theirs), "");
    StartAnew();
  }
}

// What the log tells of an atlas that was removed is none of the next of that name.
TEST_P(GaveUpTest, OfAnotherAtlasOfThatName) {
  for (const auto& [one, other] : BothWays()) {
    SaveSome(one, "a", 1);
    Sync();
    Writer(other).Remove("a");
    SaveSome(other, "a", 3, 2);
    Writer(other).GiveUp({.keep = 1});
    EXPECT_THAT(Told(Sync()), ElementsAre("diverged a"));
    StartAnew();
  }
}

TEST_P(GaveUpTest, WhatABranchCannotBeginWith) {
  Atlas ours = SaveSome(first_, "a", 1), theirs = ours;
  Sync();
  GoOn(first_, ours, 2, 3);
  GoOn(second_, theirs, 2, 2, 10);
  Writer(first_).GiveUp({.keep = 1});
  const SyncReport report = Sync({.branch_diverged = true});
  ASSERT_THAT(report.atlases, SizeIs(1));
  EXPECT_THAT(report.atlases[0].revisions, ElementsAre(3));
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load(report.atlases[0].branch), ours), "");
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load("a"), theirs), "");
}

// As after a restore whose revisions between were given up: the same content twice in a row.
TEST_P(SyncTest, RevisionsThatAreAlikeStayTwo) {
  SaveSome(first_, "a", 2);
  Writer(first_).Restore("a@1");
  Writer(first_).Tag("a@1", "start");
  Writer(first_).GiveUp({.keep = 1});
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 1 3 to second #start to second"));
  ExpectSame("a");
  ExpectNothingToDo();
}

TEST_P(SyncTest, WhatWasSavedForItselfIsKnownByItsHash) {
  Atlas atlas = SaveSome(first_, "a", 3);
  Save(second_, "a", atlas);      // is revision 1 there
  ExpectNothingToDo({"same a"});  // with what one has before
  Change(atlas, 4);
  Save(first_, "a", atlas);
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 4 to second"));
  EXPECT_EQ(Store::Open(second_).FindRevision("a").number, 4U);
  Change(atlas, 5);
  Save(second_, "a", atlas);
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 5 to first"));
  ExpectNothingToDo({"same a"});  // with what one has before
}

TEST_P(SyncTest, ANumberThatIsTakenBecomesTheNext) {
  Atlas atlas = Made(1);
  Save(first_, "a", atlas);
  SaveSome(second_, "a", 2, 2);
  Save(second_, "a", atlas);  // is revision 3 there
  Change(atlas, 4);
  Save(first_, "a", atlas);
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 2 to second"));
  EXPECT_EQ(Store::Open(second_).FindRevision("a").number, 4U);
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load("a"), atlas), "");
  ExpectNothingToDo({"same a"});  // with what one has before
}

// As `slamdb add` copies the newest content alone.
TEST_P(SyncTest, WhatStaysInOneAloneIsTold) {
  Atlas atlas = SaveSome(first_, "a", 3);
  Writer(first_).Tag("a@2", "second");
  Writer(first_).Tag("a@3", "third");
  Save(second_, "a", atlas);
  for (const bool is_first_run : {true, false}) {
    const SyncReport report = Sync();
    EXPECT_THAT(Told(report), ElementsAre(is_first_run ? "copied a #third to second" : "same a"));
    EXPECT_EQ(report.same, is_first_run ? 0U : 1U);
    ASSERT_THAT(report.atlases[0].alone, SizeIs(1));
    const SyncedAtlas::Alone& alone = report.atlases[0].alone[0];
    EXPECT_TRUE(alone.in_first);
    EXPECT_THAT(alone.revisions, ElementsAre(1, 2));
    EXPECT_THAT(alone.tags, ElementsAre("second"));
  }
  // Also when newer ones go the other way, but not of what is not asked for.
  Change(atlas, 7);
  Save(second_, "a", atlas);
  const SyncReport report = Sync();
  EXPECT_THAT(Told(report), ElementsAre("copied a 2 to first"));
  EXPECT_THAT(report.atlases[0].alone, SizeIs(1));
  EXPECT_EQ(SyncStores(second_, first_, {.one_way = true}).same, 1U);
  EXPECT_THAT(SyncStores(second_, first_, {.one_way = true}).atlases, IsEmpty());
  // What was given up is not missed.
  Writer(first_).Untag("a", "second");
  Writer(first_).GiveUp({.keep = 2});
  ExpectNothingToDo();
}

class DivergedTest : public SyncTest {
 protected:
  // Both go on from revision 2.
  void SetUp() override {
    SyncTest::SetUp();
    if (IsSkipped()) return;
    ours_ = theirs_ = SaveSome(first_, "a", 2);
    Sync();
    Change(ours_, 3);
    Change(theirs_, 5);
    Save(first_, "a", ours_);
    Save(second_, "a", theirs_);
  }
  Atlas ours_, theirs_;
};
INSTANTIATE_TEST_SUITE_P(All, DivergedTest,
                         ::testing::Values(Pair{Keeper::kFile, Keeper::kFile}, Pair{Keeper::kFile, Keeper::kServer}),
                         NameOfPair);

TEST_P(DivergedTest, StaysAsItIs) {
  const auto first = LogOf(first_, "a"), second = LogOf(second_, "a");
  const SyncReport report = Sync();
  EXPECT_THAT(Told(report), ElementsAre("diverged a"));
  EXPECT_EQ(report.Count(SyncResult::kDiverged), 1U);
  EXPECT_EQ(LogOf(first_, "a"), first);
  EXPECT_EQ(LogOf(second_, "a"), second);
}

TEST_P(DivergedTest, BecomesABranchThatCanBeMerged) {
  Writer(first_).Tag("a", "mine");
  const std::string who = Store::Open(first_).Log("a").back().who;
  const std::string branch = "a-of-" + who.substr(who.find('@') + 1);
  EXPECT_THAT(Told(Sync({.branch_diverged = true})),
              ElementsAre("branched a 2 3 to second as " + branch + " #mine to second"));
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load(branch), ours_), "");
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load("a"), theirs_), "");
  const std::optional<RevisionName> base = Store::Open(second_).CommonBase("a", branch);
  ASSERT_TRUE(base);
  EXPECT_EQ(base->ToString(), "a@2");

  // More of it goes the same way, and the branch comes home.
  Change(ours_, 7);
  Save(first_, "a", ours_);
  EXPECT_THAT(Told(Sync({.branch_diverged = true})), ElementsAre("branched a 4 to second as " + branch));
  EXPECT_THAT(Told(Sync({.branch_diverged = true})),
              ElementsAre("branched a as " + branch, "copied " + branch + " 2 3 4 to first #mine to first"));

  // Where both were made one, the first follows.
  Atlas merged = ours_;
  Change(merged, 9);
  Save(second_, "a", merged, {.from = Store::Open(second_).FindRevision(branch)});
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 4 to first"));
  EXPECT_EQ(FirstDifference(Store::Open(first_).Load("a"), merged), "");
  ExpectNothingToDo();
}

// To go back is to go on.
TEST_P(DivergedTest, ARestoredRevisionIsNotTakenForTheOldOne) {
  Store store = Writer(first_);
  store.Restore("a@1");
  const auto first = LogOf(first_, "a"), second = LogOf(second_, "a");
  EXPECT_THAT(Told(Sync()), ElementsAre("diverged a"));
  EXPECT_EQ(LogOf(first_, "a"), first);
  EXPECT_EQ(LogOf(second_, "a"), second);
}

// As that of another robot whose host has the same name.
TEST_P(DivergedTest, ABranchOfThatNameIsNotSavedOver) {
  const std::string who = Store::Open(first_).Log("a").back().who;
  const std::string name = "a-of-" + who.substr(who.find('@') + 1);
  Save(second_, name, Made(9));
  const SyncOptions options{.names = {"a"}, .branch_diverged = true};
  EXPECT_THAT(Told(Sync(options)), ElementsAre("branched a 2 3 to second as " + name + "-2"));
  EXPECT_EQ(HashOf(Store::Open(second_).Load(name)), HashOf(Made(9)));
  EXPECT_EQ(FirstDifference(Store::Open(second_).Load(name + "-2"), ours_), "");
  EXPECT_EQ(Store::Open(second_).CommonBase("a", name + "-2")->ToString(), "a@2");
  // It goes on there, and a third robot beside both.
  Change(ours_, 7);
  Save(first_, "a", ours_);
  EXPECT_THAT(Told(Sync(options)), ElementsAre("branched a 4 to second as " + name + "-2"));
  const std::string third = folder_ / "third.db";
  SaveSome(third, "a", 2);
  Save(third, "a", Made(8));
  EXPECT_THAT(Told(SyncStores(third, second_, options)), ElementsAre("branched a 2 3 to second as " + name + "-3"));
}

// Robots of one host name come home at the same time.
TEST_P(DivergedTest, ABranchOfThatNameThatAnotherMakesMeanwhileIsNotSavedOver) {
  const std::string who = Store::Open(first_).LogOf({"a", 2}).who;
  const std::string name = "a-of-" + who.substr(who.find('@') + 1);
  const Atlas another = Made(77);
  bool is_saved = false;
  SyncOptions options{.names = {"a"}, .branch_diverged = true};
  options.progress = [&](std::string_view stage, double) {
    if (is_saved || stage.find(", revision") == std::string_view::npos) return;
    is_saved = true;
    Writer(second_).Save(name, another);
  };
  const SyncReport report = Sync(options);
  ASSERT_TRUE(is_saved);
  ASSERT_THAT(report.atlases, SizeIs(1));
  EXPECT_EQ(report.atlases[0].failure, "");
  EXPECT_EQ(report.atlases[0].branch, name + "-2");
  EXPECT_EQ(HashOf(Store::Open(second_).Load(name)), HashOf(another));
  EXPECT_EQ(HashOf(Store::Open(second_).Load(name + "-2")), HashOf(Store::Open(first_).Load("a")));
}

TEST_P(SyncTest, OneWayLeavesTheFirst) {
  Atlas atlas = SaveSome(first_, "a", 2);
  Save(second_, "b", Made(2));
  EXPECT_THAT(Told(Sync({.one_way = true})), ElementsAre("copied a 1 2 to second", "ahead b"));
  EXPECT_THAT(Store::Open(first_).Names(), ElementsAre("a"));
  Change(atlas, 3);
  Save(second_, "a", atlas);
  Writer(second_).Tag("a", "theirs");
  EXPECT_THAT(Told(Sync({.one_way = true})), ElementsAre("ahead a", "ahead b"));
  EXPECT_THAT(LogOf(first_, "a"), SizeIs(2));
}

TEST_P(SyncTest, ADryRunWritesNothing) {
  SaveSome(first_, "a", 2);
  Writer(first_).Tag("a", "release");
  const SyncReport dry = Sync({.dry_run = true});
  EXPECT_TRUE(Store::IsYetToBeMade(second_));
  SyncReport done = Sync();
  EXPECT_EQ(Told(dry), Told(done));
  EXPECT_THAT(Told(done), ElementsAre("copied a 1 2 to second #release to second"));
}

TEST_P(SyncTest, OnlyAtlasesThatAreNamed) {
  for (const char* name : {"a", "b", "c"}) Save(first_, name, Made(1));
  const SyncReport report = Sync({.names = {"c", "a", "nobody"}});
  EXPECT_THAT(Told(report), ElementsAre("copied a 1 to second", "copied c 1 to second", "failed nobody"));
  EXPECT_THAT(report.atlases[2].failure, HasSubstr("has an atlas named 'nobody'"));
  EXPECT_THAT(Store::Open(second_).Names(), ElementsAre("a", "c"));
}

TEST_P(SyncTest, AnAtlasThatWasRemovedComesBack) {
  SaveSome(first_, "a", 2);
  Sync();
  Writer(first_).Remove("a");
  EXPECT_THAT(Told(Sync()), ElementsAre("copied a 1 2 to first"));
  ExpectSame("a");
}

TEST_P(SyncTest, NamesOfAnyKind) {
  const std::vector<std::string> names = {
      "a@b", "a",    "o'neill \"x\" \\n",  "\xC3\xBC\xE2\x82\xAC \xF0\x9F\x98\x80", "100%_{}",
      "A",   "-- ;", std::string(255, 'n')};
  for (const std::string& name : names) Save(first_, name, Made(1));
  EXPECT_EQ(Sync().Count(SyncResult::kCopied), names.size());
  EXPECT_EQ(Store::Open(second_).Names(), Store::Open(first_).Names());
  for (const std::string& name : names) ExpectSame(name);
  ExpectNothingToDo();
}

TEST_P(SyncTest, EmptyStores) {
  EXPECT_EQ(KindOf([&] { Sync(); }), ErrorKind::kNotFound);
  Save(second_, "a", Made(1));
  EXPECT_EQ(KindOf([&] { Sync({.one_way = true}); }), ErrorKind::kNotFound);
  Writer(second_).Remove("a");
  EXPECT_THAT(Told(Sync()), IsEmpty());
  EXPECT_TRUE(Store::IsYetToBeMade(first_));  // nothing had to be copied there
}

TEST_P(SyncTest, OneStoreTwiceIsRefused) {
  Save(first_, "a", Made(1));
  const Error error = ErrorOf([&] { SyncStores(first_, first_, {}); });
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_THAT(error.what(), HasSubstr("is the store that it is to be compared with"));
}

// Wherever it ends, what is there is whole, and the next run goes on.
TEST_P(SyncTest, GoesOnWhereItStopped) {
  SaveSome(first_, "a", 3);
  SaveSome(second_, "b", 3, 2);
  int stops = 0;
  for (bool done = false; !done;) {
    int calls = 0;
    bool is_told = false;
    SyncOptions options;
    options.progress = [&](std::string_view, double) {
      if (++calls > 5 + 2 * stops) throw std::runtime_error("stopped");
    };
    options.on_stopped = [&](const SyncReport&) { is_told = true; };
    try {
      Sync(options);
      done = true;
    } catch (const std::runtime_error& error) {
      ++stops;
      EXPECT_TRUE(is_told) << error.what();
    }
    ASSERT_LT(stops, 200);
  }
  EXPECT_GT(stops, 3);
  for (const char* name : {"a", "b"}) ExpectSame(name);
  ExpectNothingToDo();
}

TEST_P(SyncTest, GoesOnAfterItWasKilled) {
  SaveSome(first_, "a", 4);
  for (int when : {6, 8, 10}) {
    const pid_t child = ::fork();
    if (child == 0) {
      int calls = 0;
      SyncOptions options{.threads = 1};
      options.progress = [&](std::string_view, double) {
        if (++calls == when) ::kill(::getpid(), SIGKILL);
      };
      try {
        Sync(options);
      } catch (const std::exception&) {
      }
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "it had ended before call " << when;
  }
  Sync();
  ExpectSame("a");
  ExpectNothingToDo();
}

class PagesTest : public SyncTest {};
INSTANTIATE_TEST_SUITE_P(All, PagesTest,
                         ::testing::Values(Pair{Keeper::kFile, Keeper::kFile}, Pair{Keeper::kFile, Keeper::kServer}),
                         NameOfPair);

TEST_P(PagesTest, OfMoreAtlasesThanAreComparedAtOnce) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 2, .points = 5, .features = 8});
  // More than a page in the first, and some that only the second has, before, between and behind.
  {
    Store store = Writer(first_);
    for (int i = 0; i < 1050; ++i) store.Save("n" + std::to_string(10000 + i), atlas, {.threads = 1});
  }
  {
    Store store = Writer(second_);
    for (const char* name : {"a", "n10999x", "n11049x", "z"}) store.Save(name, atlas, {.threads = 1});
  }
  EXPECT_EQ(Sync({.one_way = true, .threads = 1}).Count(SyncResult::kAhead), 4U);
  EXPECT_EQ(Sync({.threads = 1}).Count(SyncResult::kCopied), 4U);
  EXPECT_EQ(Store::Open(first_).Names(), Store::Open(second_).Names());
  EXPECT_THAT(Store::Open(first_).Names(), SizeIs(1054));
  ExpectNothingToDo();
}

// ---- what helps it: Store::LoadOnto

class LoadOntoTest : public SyncTest {};
INSTANTIATE_TEST_SUITE_P(All, LoadOntoTest,
                         ::testing::Values(Pair{Keeper::kFile, Keeper::kFile}, Pair{Keeper::kServer, Keeper::kServer}),
                         NameOfPair);

TEST_P(LoadOntoTest, GivesTheRevisionWhateverTheBaseHolds) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kStereo, .maps = 2, .keyframes = 8, .points = 200, .features = 160});
  std::vector<Atlas> saved;
  for (int i = 1; i <= 5; ++i) {
    if (i > 1) Change(atlas, i);
    if (i == 4) std::swap(atlas.maps[0].points.front(), atlas.maps[0].points.back());
    if (i == 5) std::swap(atlas.maps[0], atlas.maps[1]);
    Save(first_, "a", atlas);
    saved.push_back(atlas);
  }
  std::vector<Atlas> bases = saved;
  bases.push_back({});
  bases.push_back(Made(7));  // the same ids, another content
  Store store = Store::Open(first_);
  for (std::size_t i = 0; i < saved.size(); ++i)
    for (std::size_t k = 0; k < bases.size(); ++k)
      EXPECT_EQ(FirstDifference(store.LoadOnto({"a", i + 1}, bases[k]), saved[i]), "") << i << " onto " << k;
  EXPECT_THAT(ErrorOf([&] { store.LoadOnto({"a", 6}, {}); }).what(), HasSubstr("it has 1 to 5"));
  EXPECT_THAT(ErrorOf([&] { store.LoadOnto({"b", 1}, {}); }).what(), HasSubstr("no atlas named 'b'"));
}

TEST_P(LoadOntoTest, TwiceTheSameInTheAtlas) {
  Atlas atlas = Made(1);
  atlas.maps[0].points.push_back(atlas.maps[0].points.front());
  atlas.maps[0].keyframes.push_back(atlas.maps[0].keyframes.front());
  Save(first_, "a", atlas);
  EXPECT_EQ(FirstDifference(Store::Open(first_).LoadOnto({"a", 1}, Made(1)), atlas), "");
}

TEST_P(LoadOntoTest, ANumberThatIsTakenIsRefused) {
  SaveSome(first_, "a", 2);
  const SaveOptions options{.recorded = Recorded{.number = 2, .at = "2026-01-31T12:00:00Z", .who = "a@b", .tool = "c"}};
  EXPECT_EQ(KindOf([&] { Save(first_, "a", Made(3), options); }), ErrorKind::kUsage);
  EXPECT_THAT(LogOf(first_, "a"), SizeIs(2));
}

// ---- a server that comes and goes

TEST(SyncWithServer, RetriesWhenTheConnectionIsLost) {
  if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  PostgresqlServer server;
  const TemporaryFolder folder;
  const std::string file = folder / "s.db", uri = server.Uri(server.MakeDatabase());
  for (int i = 0; i < 3; ++i)
    Store::OpenForWriting(file).Save("a" + std::to_string(i), Made(static_cast<std::uint64_t>(i + 1)));
  const auto with_loss = [&](int retries) {
    SyncOptions options{.retries = retries};
    bool lost = false;
    options.on_done = [&](const SyncedAtlas&) {
      if (!std::exchange(lost, true)) server.Kill();
    };
    options.on_retry = [&](const Error& error, double) {
      EXPECT_TRUE(IsWorthRetrying(error)) << error.what();
      server.Start();
    };
    return SyncStores(file, uri, options);
  };
  const Error error = ErrorOf([&] { with_loss(0); });
  EXPECT_TRUE(error.kind() == ErrorKind::kLocked || error.kind() == ErrorKind::kNotFound) << error.what();
  EXPECT_THAT(error.what(), HasSubstr("the next run goes on from there"));
  server.Start();
  EXPECT_EQ(with_loss(3).Count(SyncResult::kCopied), 2U);  // one was copied before
  EXPECT_THAT(Store::Open(uri).Names(), ElementsAre("a0", "a1", "a2"));
}

// What a server of a fleet has is not brought while it is down, and everything else is.
TEST(SyncOfAFleet, OneServerDownTakesItsAtlasesAlone) {
  if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  PostgresqlServer own, other;
  const std::string fleet = own.Uri(own.MakeDatabase());
  InitFleet(fleet, 4, std::vector<std::string>{other.Uri(other.MakeDatabase())});
  const std::string moved = own.Uri(own.MakeDatabase());
  MovePartition(fleet, 0, moved);
  MovePartition(fleet, 2, moved);
  TemporaryFolder folder;
  const std::string file = folder / "robot.db";
  constexpr int kAtlases = 6;
  for (int i = 0; i < kAtlases; ++i)
    Store::OpenForWriting(file, {.sync = false}).Save("a" + std::to_string(i), Made(static_cast<std::uint64_t>(i + 1)));
  SyncStores(file, fleet, {});
  other.Kill();
  ASSERT_FALSE(ReadFleet(fleet).ok());
  const std::string copy = folder / "copy.db";
  int waits = 0;
  SyncOptions options{.retries = 1};
  options.on_retry = [&](const Error&, double) { ++waits; };
  const SyncReport home = SyncStores(fleet, copy, options);
  EXPECT_EQ(waits, 1) << "once for all atlases of the server";
  EXPECT_GT(home.Count(SyncResult::kFailed), 0U);
  EXPECT_GT(home.Count(SyncResult::kCopied), 0U);
  EXPECT_EQ(home.Count(SyncResult::kFailed) + home.Count(SyncResult::kCopied), 6U);
  for (const SyncedAtlas& atlas : home.atlases)
    if (atlas.result == SyncResult::kFailed) {
      EXPECT_THAT(atlas.failure, HasSubstr("another server"));
    }
  other.Start();
  EXPECT_EQ(SyncStores(fleet, copy, {}).Count(SyncResult::kFailed), 0U);
  EXPECT_EQ(Store::Open(copy).Names().size(), 6U);
}

}  // namespace
}  // namespace slamdb
