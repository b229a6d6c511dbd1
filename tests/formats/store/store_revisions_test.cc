// SPDX-License-Identifier: BSD-3-Clause
// Revisions: every save can be read again, costs what it changed, and can be given up.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <set>

#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::uint64_t Count(const std::string& path, const std::string& from) {
  return std::stoull(Sql(path, "SELECT count(*) FROM " + from));
}

class StoreRevisions : public ::testing::Test {
 protected:
  // Each as it was when it was saved.
  void ExpectAllThere() {
    Store store = Store::Open(path_);
    for (const auto& [number, atlas] : saved_)
      ASSERT_EQ(FirstDifference(store.Load("a@" + std::to_string(number)), atlas), "") << "revision " << number;
  }
  SaveReport Save(const Atlas& atlas) {
    const SaveReport report = SaveIn(path_, atlas);
    saved_.emplace_back(report.revision, atlas);
    return report;
  }
  std::string FindError(const std::string& name) {
    return ErrorOf([&] { Store::Open(path_).Load(name); });
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  std::vector<std::pair<std::uint64_t, Atlas>> saved_;
};

TEST_F(StoreRevisions, AreCountedAndReadByNumberFromTheEndAndByTag) {
  Atlas atlas = SoundAtlas();
  EXPECT_EQ(Save(atlas).revision, 1U);
  atlas.maps[0].points[3].position.x() += 1;
  EXPECT_EQ(Save(atlas).revision, 2U);
  atlas.maps[0].keyframes.pop_back();
  EXPECT_EQ(Save(atlas).revision, 3U);
  ExpectAllThere();
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Tag("a@2", "release");
  EXPECT_EQ(FirstDifference(store.Load("a@release"), saved_[1].second), "");
  EXPECT_EQ(FirstDifference(store.Load("a@-2"), saved_[0].second), "");
  EXPECT_EQ(FirstDifference(store.Load("a@{2999-12-31}"), saved_[2].second), "");
  EXPECT_EQ(store.FindRevision("a@-1"), (RevisionName{"a", 2, HashOf(saved_[1].second)}));
}

TEST_F(StoreRevisions, ByDateIsTheNewestThatWasThere) {
  Atlas atlas = SoundAtlas();
  for (int i = 0; i < 3; ++i) {
    atlas.maps[0].points[0].position.x() += 1;
    Save(atlas);
  }
  Sql(path_, "UPDATE history SET at = '2026-11-1' || revision || 'T08:30:0' || revision || 'Z' WHERE action = 'save'");
  Store store = Store::Open(path_);
  EXPECT_EQ(store.FindRevision("a@{2026-11-12}").number, 2U);
  EXPECT_EQ(store.FindRevision("a@{2026-11-12T08:29}").number, 1U);
  EXPECT_EQ(store.FindRevision("a@{2026-11-12 08:30}").number, 2U);
  EXPECT_EQ(store.FindRevision("a@{2026-11-13T08:30:02Z}").number, 2U);
  EXPECT_EQ(store.FindRevision("a@{2026-11-13T08:30:03Z}").number, 3U);
  EXPECT_THAT(FindError("a@{2026-11-10}"), HasSubstr("none that is left was saved by then; it has 1 to 3"));
  EXPECT_THAT(FindError("a@{yesterday}"), HasSubstr("is no date: expected {2026-11-20}"));
}

TEST_F(StoreRevisions, WhatIsNotThereIsNamedWithWhatIs) {
  Save(SoundAtlas());
  EXPECT_THAT(FindError("a@2"), HasSubstr("no revision '2' of 'a'; it has 1"));
  EXPECT_THAT(FindError("a@0"), HasSubstr("no revision '0' of 'a'"));
  EXPECT_THAT(FindError("a@-1"), HasSubstr("no revision '-1' of 'a'"));
  EXPECT_THAT(FindError("a@"), HasSubstr("no revision '' of 'a'"));
  EXPECT_THAT(FindError("a@release"), HasSubstr("no revision 'release' of 'a'"));
  EXPECT_THAT(FindError("b@1"), HasSubstr("no atlas named 'b'; it holds a"));
  EXPECT_THAT(FindError("a@99999999999999999999"), HasSubstr("no revision '99999999999999999999' of 'a'"));
}

TEST_F(StoreRevisions, AreNotSavedOverAndNamesWithAnAtStay) {
  SaveIn(path_, SoundAtlas(), "robot@home");
  EXPECT_EQ(FirstDifference(LoadFrom(path_, "robot@home"), SoundAtlas()), "");
  SaveIn(path_, OddAtlas(), "robot");
  EXPECT_EQ(FirstDifference(LoadFrom(path_, "robot@home"), SoundAtlas()), "") << "the whole name goes first";
  EXPECT_EQ(FirstDifference(LoadFrom(path_, "robot@home@1"), SoundAtlas()), "");
  Store::OpenForWriting(path_).Tag("robot", "depot");
  for (const char* name : {"robot@1", "robot@-1", "robot@{2026-11-20}", "robot@depot", "other@7"})
    EXPECT_THAT(ErrorOf([&] { SaveIn(path_, Atlas(), name); }), HasSubstr("stands for a revision")) << name;
  EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(path_).Remove("robot@1"); }), HasSubstr("is one revision"));
}

// Whatever happens to an atlas: points and keyframes come, go, move and change places, ids repeat, maps change their id
// or go, and come again.
Atlas Edited(Atlas atlas, std::mt19937& random) {
  const auto pick = [&](std::size_t size) { return static_cast<std::ptrdiff_t>(random() % size); };
  if (atlas.maps.empty()) return OddAtlas();
  ++atlas.next_ids.frame;  // so that something is another in any case
  Map& map = atlas.maps[random() % atlas.maps.size()];
  switch (random() % 12) {
    case 0:
      if (!map.points.empty()) map.points.erase(map.points.begin() + pick(map.points.size()));
      break;
    case 1:
      map.points.insert(map.points.begin() + pick(map.points.size() + 1), MapPoint());
      break;
    case 2:
      std::shuffle(map.points.begin(), map.points.end(), random);
      break;
    case 3:
      std::shuffle(map.keyframes.begin(), map.keyframes.end(), random);
      break;
    case 4:
      if (!map.keyframes.empty()) map.keyframes.erase(map.keyframes.begin() + pick(map.keyframes.size()));
      break;
    case 5:
      if (!map.keyframes.empty()) map.keyframes.push_back(map.keyframes[random() % map.keyframes.size()]);
      break;
    case 6:
      for (MapPoint& point : map.points) point.position.x() += 1;
      break;
    case 7:
      map.id = MapId(random() % 1000);
      break;
    case 8:
      if (!map.keyframes.empty()) {
        KeyFrame& keyframe = map.keyframes[random() % map.keyframes.size()];
        keyframe.features.map_points.assign(keyframe.features.map_points.size(), MapPointId(random() % 9));
        keyframe.connections.clear();
        keyframe.loop_edges.push_back(KeyFrameId(random() % 9));
      }
      break;
    case 9:
      if (atlas.maps.size() > 1) atlas.maps.erase(atlas.maps.begin() + pick(atlas.maps.size()));
      break;
    case 10:
      atlas.maps.push_back(SoundAtlas().maps[random() % 2]);
      break;
    default:
      if (!map.points.empty()) map.points[random() % map.points.size()].observations.clear();
      atlas.next_ids.map_point += 1;
      if (!atlas.cameras.empty()) std::rotate(atlas.cameras.begin(), atlas.cameras.begin() + 1, atlas.cameras.end());
  }
  return atlas;
}

TEST_F(StoreRevisions, RandomEditsAllComeBack) {
  std::mt19937 random(11);
  Atlas atlas = OddAtlas();
  for (int step = 0; step < 40; ++step) {
    Save(atlas);
    SaveIn(path_, SoundAtlas(), "beside " + std::to_string(step % 3));  // whose rows must not mix with these
    atlas = Edited(std::move(atlas), random);
  }
  ExpectAllThere();
  EXPECT_EQ(Sql(path_, "PRAGMA integrity_check"), "ok");
  Store::OpenForWriting(path_, {.sync = false}).Vacuum();
  ExpectAllThere();
}

TEST_F(StoreRevisions, GivingSomeUpLeavesTheOthers) {
  std::mt19937 random(13);
  Atlas atlas = OddAtlas();
  for (int step = 0; step < 24; ++step) {
    Save(atlas);
    atlas = Edited(std::move(atlas), random);
  }
  Store store = Store::OpenForWriting(path_, {.sync = false});
  for (const char* each : {"a@3", "a@4", "a@9", "a@17"}) store.Tag(each, "t" + std::string(each + 2));
  const GiveUpReport planned = store.GiveUp({.keep = 3, .dry_run = true});
  EXPECT_EQ(planned.atlases[0].kept, 7U);
  EXPECT_EQ(Count(path_, "revision"), 24U) << "a dry run";
  const GiveUpReport report = store.GiveUp({.keep = 3});
  EXPECT_EQ(report.atlases[0].revisions, planned.atlases[0].revisions);
  EXPECT_GT(report.bytes, 0U);
  EXPECT_THAT(FindError("a@5"), HasSubstr("it has 3, 4, 9, 17, 22 to 24, tagged t17, t3, t4, t9"));
  std::erase_if(
      saved_, [](const auto& each) { return !std::set<std::uint64_t>{3, 4, 9, 17, 22, 23, 24}.contains(each.first); });
  ExpectAllThere();
  EXPECT_TRUE(store.GiveUp({.keep = 3}).atlases[0].revisions.empty());
  for (const char* tag : {"t3", "t4", "t9", "t17"}) store.Untag("a", tag);
  EXPECT_EQ(store.GiveUp({.keep = 1}).atlases[0].kept, 1U);
  EXPECT_EQ(Count(path_, "past"), 0U);
  EXPECT_EQ(Count(path_, "picture WHERE NOT EXISTS (SELECT 1 FROM keyframe_features WHERE picture = picture.row)"), 0U);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), saved_.back().second), "");
}

TEST_F(StoreRevisions, AreKeptForSomeDays) {
  Atlas atlas = SoundAtlas();
  for (int i = 0; i < 3; ++i) {
    atlas.maps[0].points[0].position.x() += 1;
    Save(atlas);
  }
  Sql(path_, "UPDATE history SET at = '2020-01-01T00:00:00Z' WHERE revision = 1");
  const GiveUpReport report = Store::OpenForWriting(path_).GiveUp({.keep_days = 7});
  EXPECT_THAT(report.atlases[0].revisions, ElementsAre(1));
  EXPECT_EQ(report.atlases[0].kept, 2U);
}

TEST_F(StoreRevisions, WhatTheLogHasLostStaysByItsTag) {
  Atlas atlas = SoundAtlas();
  for (int i = 0; i < 4; ++i) {
    atlas.maps[0].points[0].position.x() += 1;
    Save(atlas);
  }
  Store store = Store::OpenForWriting(path_);
  store.Tag("a@1", "kept");
  Sql(path_, "DELETE FROM history WHERE revision <= 2");
  const GiveUpReport report = store.GiveUp({.keep_days = 7});
  EXPECT_THAT(report.atlases[0].revisions, ElementsAre(2)) << "it counts as saved long ago";
  EXPECT_EQ(FirstDifference(store.Load("a@kept"), saved_[0].second), "");
  EXPECT_THAT(store.GiveUp({.keep = 50}).atlases[0].revisions, ElementsAre());
}

TEST_F(StoreRevisions, TellWhatTheyChanged) {
  Atlas atlas = SoundAtlas();
  const SaveReport first = Save(atlas);
  EXPECT_EQ(first.map.keyframes_added, atlas.maps[0].keyframes.size() + atlas.maps[1].keyframes.size());
  EXPECT_EQ(first.map.keyframes_removed + first.map.keyframes_moved, 0U);
  Map& map = atlas.maps[0];
  const std::size_t observed = map.points[1].observations.size();
  map.points.erase(map.points.begin() + 1);
  map.points.insert(map.points.begin(), MapPoint());
  map.points[7].position.z() += 1;
  map.points[8].visible_count += 1;  // which moves nothing
  map.keyframes[2].camera_from_world.translation.x() += 1;
  map.keyframes[3].velocity.x() += 1;  // nor does this
  std::swap(map.keyframes[0], map.keyframes[5]);
  const MapChanges changes = Save(atlas).map;
  EXPECT_EQ(changes, (MapChanges{.keyframes_moved = 1,
                                 .points_added = 1,
                                 .points_removed = 1,
                                 .points_moved = 1,
                                 .observations_removed = observed}));
  const std::vector<HistoryEntry> log = Store::Open(path_).Log("a");
  EXPECT_EQ(log[1].changes, changes);
  EXPECT_EQ(log[1].revision, 2U);
  EXPECT_TRUE(log[0].readable && log[1].readable);
  EXPECT_THAT(log[1].who, HasSubstr("@"));
}

TEST_F(StoreRevisions, RestoreMakesOneTheNewestAgain) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps.pop_back();
  Save(atlas);
  Store store = Store::OpenForWriting(path_, {.sync = false});
  EXPECT_EQ(store.Restore("a@1").revision, 3U);
  saved_.emplace_back(3, saved_[0].second);
  ExpectAllThere();
  EXPECT_EQ(store.Log("a").back().provenance, "restore a@1");
  EXPECT_THAT(ErrorOf([&] { store.Restore("a"); }), HasSubstr("is the newest of 'a'"));
}

TEST_F(StoreRevisions, BranchesKnowWhereTheyCameFrom) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points[0].position.x() += 1;
  Save(atlas);
  Store store = Store::OpenForWriting(path_, {.sync = false});
  const std::uint64_t pictures = Count(path_, "picture");
  store.Branch("a@1", "robot7");
  EXPECT_EQ(Count(path_, "picture"), pictures) << "shared";
  EXPECT_EQ(FirstDifference(store.Load("robot7"), saved_[0].second), "");
  EXPECT_EQ(store.Log("robot7").back().from, (RevisionName{"a", 1, HashOf(saved_[0].second)}));
  EXPECT_THAT(ErrorOf([&] { store.Branch("a", "robot7"); }), HasSubstr("holds an atlas named 'robot7' already"));

  atlas.maps[1].points[0].position.x() += 1;
  store.Save("robot7", atlas);
  EXPECT_EQ(store.CommonBase("a", "robot7"), (RevisionName{"a", 1, HashOf(saved_[0].second)}));
  EXPECT_EQ(store.CommonBase("robot7", "a"), store.CommonBase("a", "robot7"));
  // What was merged is a base for the next merge.
  store.Save("a", atlas, {.from = store.FindRevision("robot7")});
  EXPECT_EQ(store.CommonBase("a", "robot7"), (RevisionName{"robot7", 2, HashOf(atlas)}));
  SaveIn(path_, OddAtlas(), "stranger");
  EXPECT_EQ(store.CommonBase("a", "stranger"), std::nullopt);
  // Both are bases, and stay.
  store.GiveUp({.keep = 1});
  EXPECT_EQ(store.CommonBase("a", "robot7")->ToString(), "robot7@2");
  EXPECT_EQ(FirstDifference(store.Load("a@1"), saved_[0].second), "");
}

// As robots come home: lab stands still, or goes on, or takes a merge back.
TEST_F(StoreRevisions, TheBaseIsTheLastThatBothHave) {
  Atlas atlas = SoundAtlas();
  const auto next = [&] {
    atlas.maps[0].points[0].position.x() += 1;
    return atlas;
  };
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Save("lab", atlas);
  store.Branch("lab", "robot");
  store.Save("robot", next());
  store.Save("lab", next(), {.from = store.FindRevision("robot")});  // lab@2, the merge
  store.Save("lab", next());
  store.Save("robot", next());
  EXPECT_EQ(store.CommonBase("lab", "robot")->ToString(), "robot@2");
  EXPECT_EQ(store.CommonBase("robot", "lab")->ToString(), "robot@2");
  // With less of the history left, it is the same.
  store.GiveUp({.keep = 1});
  EXPECT_EQ(store.CommonBase("lab", "robot")->ToString(), "robot@2");
  // What was merged and taken back is not a base any more.
  store.Restore("lab@1");
  EXPECT_EQ(store.CommonBase("lab", "robot")->ToString(), "lab@1");
}

TEST_F(StoreRevisions, IsSavedOntoTheOneThatItWasMadeOf) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points[0].position.x() += 1;
  Store store = Store::OpenForWriting(path_, {.sync = false});
  EXPECT_EQ(store.Save("a", atlas, {.onto = 1}).revision, 2U);
  EXPECT_THAT(ErrorOf([&] { store.Save("a", SoundAtlas(), {.onto = 1}); }),
              HasSubstr("'a' has revision 2 by now, and this was made of 1: nothing was saved"));
  EXPECT_EQ(FirstDifference(store.Load("a"), atlas), "");
}

// Of an atlas that was removed and made anew nothing is a base.
TEST_F(StoreRevisions, ABaseIsKnownByItsContent) {
  Save(SoundAtlas());
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Branch("a", "b");
  store.Remove("a");
  store.Save("a", OddAtlas());
  EXPECT_EQ(store.CommonBase("a", "b"), std::nullopt);
}

TEST_F(StoreRevisions, PicturesAreStoredOnce) {
  const Atlas atlas = SoundAtlas();
  Save(atlas);
  const std::uint64_t pictures = Count(path_, "picture");
  SaveIn(path_, atlas, "copy");
  Atlas part = atlas;
  part.maps.erase(part.maps.begin());
  for (KeyFrame& keyframe : part.maps[0].keyframes) keyframe.id = KeyFrameId(keyframe.id.value() + 1000);
  SaveIn(path_, part, "part");
  for (KeyFrame& keyframe : part.maps[0].keyframes) std::ranges::fill(keyframe.features.map_points, MapPointId());
  SaveIn(path_, part, "part");
  EXPECT_EQ(Count(path_, "picture"), pictures);
  EXPECT_EQ(FirstDifference(LoadFrom(path_, "part"), part), "");
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Remove("a");
  EXPECT_EQ(Count(path_, "picture"), pictures) << "others have them";
  store.Remove("copy");
  EXPECT_EQ(Count(path_, "picture"), part.maps[0].keyframes.size());
  store.Remove("part");
  for (const char* table : {"picture", "past", "revision", "tag"}) EXPECT_EQ(Count(path_, table), 0U) << table;
}

// Two pictures of one hash are two pictures.
TEST_F(StoreRevisions, PicturesAreComparedNotBelieved) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  Sql(path_, "UPDATE picture SET hash = 7");
  atlas.maps[0].keyframes[0].features.keypoints[0].x += 1;
  SaveIn(path_, atlas, "b");
  const std::string hash = Sql(path_, "SELECT hash FROM picture WHERE hash <> 7 LIMIT 1");
  Sql(path_, "UPDATE picture SET hash = " + hash);
  SaveIn(path_, SoundAtlas(), "c");
  for (const auto& [name, expected] : {std::pair("a", SoundAtlas()), {"b", atlas}, {"c", SoundAtlas()}})
    EXPECT_EQ(FirstDifference(LoadFrom(path_, name), expected), "") << name;
}

// ORB-SLAM3 keeps its lists by address: what is new stands anywhere.
TEST_F(StoreRevisions, NewEntriesAnywhereAndAnotherMapIdCostWhatIsNew) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  Map& map = atlas.maps[0];
  map.id = MapId(99);
  MapPoint point = map.points[0];
  point.id = MapPointId(876543);
  map.points.insert(map.points.begin() + 4, point);
  const SaveReport report = Save(atlas);
  const auto changes_of = [&](const char* table) {
    return *std::ranges::find(report.tables, table, &TableChanges::table);
  };
  EXPECT_EQ(changes_of("map_point").inserted, 1U);
  for (const char* table : {"map_point", "keyframe", "map"})
    EXPECT_EQ(changes_of(table).deleted + (table == std::string("map") ? 0 : changes_of(table).updated), 0U) << table;
  EXPECT_EQ(changes_of("keyframe").inserted + changes_of("map").inserted, 0U);
  ExpectAllThere();
}

TEST_F(StoreRevisions, PartsOfEarlierOnesAreRead) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  for (std::size_t i = 0; i < atlas.maps[0].points.size(); i += 2) atlas.maps[0].points[i].position.x() += 100;
  atlas.maps[0].keyframes.erase(atlas.maps[0].keyframes.begin() + 1);
  std::reverse(atlas.maps[0].keyframes.begin(), atlas.maps[0].keyframes.end());
  Save(atlas);
  SaveIn(folder_ / "first.db", saved_[0].second);
  Selection box, time, ids;
  box.box = Eigen::AlignedBox3f(Eigen::Vector3f(-2, -2, -2), Eigen::Vector3f(6, 2, 6));
  ids.first_keyframe = 2, ids.last_keyframe = 5;
  time.begin_time = saved_[0].second.maps[0].keyframes[1].timestamp;
  for (const Selection& selection : {box, time, ids}) {
    const Atlas part = LoadFrom(path_, "a@1", {.selection = selection});
    EXPECT_EQ(FirstDifference(part, LoadFrom(folder_ / "first.db", "a", {.selection = selection})), "");
  }
  EXPECT_TRUE(
      LoadFrom(path_, "a@1", {.features = FeatureColumns::kNone}).maps[0].keyframes[0].features.keypoints.empty());
}

TEST_F(StoreRevisions, AStoreOfVersion6GetsThemAndBack) {
  const Atlas atlas = OddAtlas();
  Save(atlas);
  MigrateBackTo(path_, 6);
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM sqlite_schema WHERE name IN ('picture', 'past', 'revision', 'tag')"), "0");
  MigrateStore(path_, {.backup = false});
  ExpectAllThere();
  EXPECT_EQ(Store::Open(path_).Log("a")[0].revision, 1U);
  Atlas next = atlas;
  std::ranges::reverse(next.maps[0].points);
  Save(next);
  ExpectAllThere();
  EXPECT_THAT(ErrorOf([&] { MigrateBackTo(path_, 6); }), HasSubstr("the store holds earlier revisions"));
  ExpectAllThere();
  Store::OpenForWriting(path_).GiveUp({.keep = 1});
  MigrateBackTo(path_, 6);  // with the lists in the order of their rows
  MigrateStore(path_, {.backup = false});
  EXPECT_EQ(FirstDifference(LoadFrom(path_), next), "");
}

TEST_F(StoreRevisions, GoingBackIsRefusedForTagsAndBranches) {
  Save(SoundAtlas());
  Store::OpenForWriting(path_).Tag("a", "release");
  EXPECT_THAT(ErrorOf([&] { MigrateBackTo(path_, 6); }), HasSubstr("revisions have tags"));
  Store::OpenForWriting(path_).Untag("a", "release");
  Store::OpenForWriting(path_).Branch("a", "b");
  EXPECT_THAT(
      ErrorOf([&] { MigrateBackTo(path_, 6); }),
      AllOf(HasSubstr("branched or merged"), HasSubstr("'slamdb convert STORE#NAME NEW.db#NAME' of each atlas")));
}

// What the error says: no other atlas has to go, and nothing that is the only copy.
TEST_F(StoreRevisions, AtlasesSavedInANewStoreGoBack) {
  Save(SoundAtlas());
  Store store = Store::OpenForWriting(path_);
  store.Branch("a", "b");
  store.Save("a", Atlas());
  store.GiveUp({.keep = 1});
  EXPECT_THAT(ErrorOf([&] { MigrateBackTo(path_, 6); }), HasSubstr("gives up those that no tag, branch"));
  const std::string copy = folder_ / "new.db";
  for (const char* name : {"a", "b"}) SaveIn(copy, LoadFrom(path_, name), name);
  MigrateBackTo(copy, 6);
  MigrateStore(copy, {.backup = false});
  EXPECT_EQ(FirstDifference(LoadFrom(copy, "b"), saved_[0].second), "");
}

TEST_F(StoreRevisions, TagsAreNamesAndStayWhereTheyAre) {
  Save(SoundAtlas());
  Save(Atlas());
  Store store = Store::OpenForWriting(path_, {.sync = false});
  for (const char* tag : {"", "7", "-7", "a@b", "{x}", "a/b", "a#b", "a\nb"})
    EXPECT_THAT(ErrorOf([&] { store.Tag("a", tag); }), HasSubstr("is no name for a revision")) << tag;
  store.Tag("a@1", "first");
  store.Tag("a@1", "first");
  store.Tag("a@1", "best");
  EXPECT_THAT(ErrorOf([&] { store.Tag("a", "first"); }), HasSubstr("revision 1 of 'a' has the tag 'first' already"));
  SaveIn(path_, Atlas(), "old");
  Sql(path_, "UPDATE atlas SET name = 'a@old' WHERE name = 'old'");
  EXPECT_THAT(ErrorOf([&] { store.Tag("a", "old"); }), HasSubstr("which would hide that tag"));
  EXPECT_THAT(ErrorOf([&] { store.Untag("a", "none"); }), HasSubstr("no tag 'none' of 'a'; it has best, first"));
  EXPECT_THAT(store.Log("a")[0].tags, ElementsAre("best", "first"));
}

// A session that goes on: each save adds a hundredth, and what is near the new part moves.
TEST_F(StoreRevisions, AHundredOfAMapThatGrowsTakeLittleMoreThanTheLast) {
  const Atlas whole = SynthesizeAtlas(
      {.sensor = Sensor::kRgbd, .keyframes = 270, .points = 13'500, .features = 500, .seed = 5, .threads = 1});
  Atlas atlas;
  double size = 100;
  for (int step = 0; step < 100; ++step, size *= 1.01) {
    atlas = whole;
    Map& map = atlas.maps[0];
    map.keyframes.resize(static_cast<std::size_t>(size));
    map.points.resize(static_cast<std::size_t>(50 * size));
    for (std::size_t i = map.points.size() * 98 / 100; i < map.points.size(); ++i)
      map.points[i].position.x() += static_cast<float>(step);
    for (std::size_t i = map.keyframes.size() * 98 / 100; i < map.keyframes.size(); ++i)
      map.keyframes[i].camera_from_world.translation.x() += static_cast<float>(step);
    const SaveReport report = SaveIn(path_, atlas);
    if (step == 0 || step == 50) saved_.emplace_back(report.revision, atlas);
  }
  SaveIn(folder_ / "last.db", atlas);
  for (const std::string& path : {path_, folder_ / "last.db"}) Store::OpenForWriting(path, {.sync = false}).Vacuum();
  const auto bytes = static_cast<double>(std::filesystem::file_size(path_));
  EXPECT_LT(bytes, 2.5 * static_cast<double>(std::filesystem::file_size(folder_ / "last.db")));
  RecordProperty("ratio", std::to_string(bytes / static_cast<double>(std::filesystem::file_size(folder_ / "last.db"))));
  ExpectAllThere();
}

// ---- damage

TEST_F(StoreRevisions, DamageInThePastIsFoundAndTheNewestIsRead) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points[3].position.x() += 1;
  atlas.maps[0].keyframes[3].camera_from_world.translation.x() += 1;
  Save(atlas);
  const std::string good = folder_ / "good.db";
  Store::Open(path_).Backup(good);
  std::mt19937 random(5);
  int damaged = 0;
  for (const char* part : {"0", "1", "2", "3", "5", "7", "8"}) {
    for (int i = 0; i < 12; ++i) {
      Store::Open(good).Backup(path_, true);
      const std::string where = " FROM past WHERE part = " + std::string(part) + " LIMIT 1";
      const std::string hex = Sql(path_, "SELECT hex(rows)" + where);
      if (hex.empty()) continue;
      std::string bad = hex;
      bad[random() % bad.size()] = "0123456789ABCDEF"[random() % 16];
      if (i == 0) bad.resize(bad.size() / 2 / 2 * 2);
      if (bad == hex) continue;
      Sql(path_,
          "UPDATE past SET rows = x'" + bad + "' WHERE part = " + std::string(part) + " AND hex(rows) = '" + hex + "'");
      const std::string error = FindError("a@1");
      damaged += error.empty() ? 0 : 1;
      // What no hash covers, like the time of the save, may be another without harm.
      if (error.empty()) {
        EXPECT_EQ(FirstDifference(LoadFrom(path_, "a@1"), saved_[0].second), "");
      }
      EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas), "");
    }
  }
  EXPECT_GT(damaged, 20);
}

// What is left of a revision of which rows are gone is sound in itself, and another one.
TEST_F(StoreRevisions, LostRowsAreMissed) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points[3].position.x() += 1;
  Save(atlas);
  const std::string good = folder_ / "good.db";
  Store::Open(path_).Backup(good);
  for (const char* damage : {"DELETE FROM past", "UPDATE past SET until = 1", "DELETE FROM past WHERE part = 8"}) {
    Store::Open(good).Backup(path_, true);
    Sql(path_, damage);
    EXPECT_THAT(FindError("a@1"), HasSubstr("revision 1 of 'a', table ")) << damage;
  }
}

TEST_F(StoreRevisions, HostileSizesTakeNoMemory) {
  Atlas atlas = SoundAtlas();
  Save(atlas);
  atlas.maps[0].points[3].position.x() += 1;
  Save(atlas);
  for (const char* rows : {"0101ff", "01ff00", "010109ffffffff10000000", "01010900ffffff0000000a00000000000000000000",
                           "010108ffffffff00", "02010000", "0100", "01"}) {
    Sql(path_, "UPDATE past SET rows = x'" + std::string(rows) + "' WHERE part = 8");
    EXPECT_THAT(FindError("a@1"), HasSubstr("revision 1 of 'a', table past")) << rows;
  }
  Sql(path_, "UPDATE past SET part = 77 WHERE part = 8");
  EXPECT_THAT(FindError("a@1"), HasSubstr("an unknown part"));
}

TEST_F(StoreRevisions, ADamagedOrderIsFound) {
  Atlas atlas = SoundAtlas();
  std::rotate(atlas.maps[0].points.begin(), atlas.maps[0].points.begin() + 3, atlas.maps[0].points.end());
  Save(SoundAtlas());
  Save(atlas);
  ExpectAllThere();
  for (const char* order : {"02", "01", "0100000000", "010000000001000000", "01ffffffffffffffff"}) {
    Sql(path_, "UPDATE map SET point_order = x'" + std::string(order) + "' WHERE position = 0");
    EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), HasSubstr("table map, row 1")) << order;
  }
}

// Rows that somebody edited are a part of the revision that had them, and of none after.
TEST_F(StoreRevisions, EditsInSqlDoNotComeBack) {
  const Atlas atlas = SoundAtlas();
  Save(atlas);
  Sql(path_, "UPDATE map_point SET x = x + 1 WHERE row = 4294967299");
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Save("a", atlas, {.verify = true});
  EXPECT_EQ(FirstDifference(store.Load("a"), atlas), "");
  EXPECT_THAT(FindError("a@1"), HasSubstr("revision 1 of 'a', table map_point, row 4294967299"));
}

}  // namespace
}  // namespace slamdb::store_test
