// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

TableChanges ChangesOf(const SaveReport& report, const std::string& table) {
  for (const TableChanges& changes : report.tables) {
    if (changes.table == table) return changes;
  }
  return {};
}

std::uint64_t Written(const TableChanges& changes) { return changes.inserted + changes.updated + changes.deleted; }

TEST(StoreIncremental, FirstSaveInsertsEverything) {
  const TemporaryFolder folder;
  const Atlas atlas = SoundAtlas();
  const SaveReport report = SaveIn(folder / "s.db", atlas);
  EXPECT_FALSE(report.replaced);
  EXPECT_EQ(ChangesOf(report, "map").inserted, 2U);
  EXPECT_EQ(ChangesOf(report, "keyframe").inserted, atlas.maps[0].keyframes.size() + atlas.maps[1].keyframes.size());
  EXPECT_EQ(ChangesOf(report, "map_point").inserted, atlas.maps[0].points.size() + atlas.maps[1].points.size());
  EXPECT_EQ(report.Total().updated + report.Total().deleted + report.Total().unchanged, 0U);
}

TEST(StoreIncremental, SavingTheSameAgainMakesNoRevision) {
  const TemporaryFolder folder;
  for (const Atlas& atlas : {SoundAtlas(), OddAtlas()}) {
    const SaveReport first = SaveIn(folder / "s.db", atlas, "x");
    const SaveReport again = SaveIn(folder / "s.db", atlas, "x");
    EXPECT_TRUE(again.replaced);
    EXPECT_EQ(again.hash, first.hash);
    EXPECT_TRUE(again.unchanged);
    EXPECT_EQ(again.revision, first.revision);
    EXPECT_EQ(Written(again.Total()), 0U);
    EXPECT_EQ(Store::Open(folder / "s.db").Log("x").size() % 2, 0U) << "the log tells of it";
  }
}

TEST(StoreIncremental, OneChangedKeyframe) {
  const TemporaryFolder folder;
  Atlas atlas = SoundAtlas();
  SaveIn(folder / "s.db", atlas);
  atlas.maps[1].keyframes[3].features.keypoints[0].x += 1;
  atlas.maps[1].keyframes[4].camera_from_world.translation.x() += 1;
  const SaveReport report = SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(ChangesOf(report, "keyframe").updated, 1U);
  EXPECT_EQ(ChangesOf(report, "keyframe_features").updated, 1U);
  EXPECT_EQ(Written(ChangesOf(report, "map_point")) + Written(ChangesOf(report, "observation")), 0U);
  EXPECT_EQ(Written(ChangesOf(report, "keyframe_link")), 0U);
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "");
}

TEST(StoreIncremental, RemovedAndAppendedEntitiesLeaveTheRestAlone) {
  const TemporaryFolder folder;
  Atlas atlas = SoundAtlas();
  SaveIn(folder / "s.db", atlas);
  Map& map = atlas.maps[0];
  map.points.erase(map.points.begin() + 5);
  map.keyframes.erase(map.keyframes.begin() + 2);
  map.points.push_back(map.points[0]);
  map.points.back().id = MapPointId(987654);
  const SaveReport report = SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(ChangesOf(report, "map_point").deleted, 1U);
  EXPECT_EQ(ChangesOf(report, "map_point").inserted, 1U);
  EXPECT_EQ(ChangesOf(report, "map_point").updated, 0U);
  EXPECT_EQ(ChangesOf(report, "keyframe").deleted, 1U);
  EXPECT_EQ(ChangesOf(report, "keyframe").updated + ChangesOf(report, "keyframe").inserted, 0U);
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "");
}

// The R*Tree takes few points one by one and many by being built anew; both ways in one connection.
TEST(StoreIncremental, BoxesFollowThePoints) {
  const TemporaryFolder folder;
  Atlas atlas = SoundAtlas();
  Store store = Store::OpenForWriting(folder / "s.db", {.sync = false});
  store.Save("a", atlas);
  atlas.maps[0].points[3].position = {50, 60, 70};
  store.Save("a", atlas);
  EXPECT_EQ(Sql(folder / "s.db", "SELECT min_x, max_z FROM map_point_box WHERE min_x > 49"), "50.0|70.0");
  EXPECT_EQ(Sql(folder / "s.db", "SELECT rtreecheck('map_point_box')"), "ok");
  for (MapPoint& point : atlas.maps[1].points) point.position.x() += 100;
  store.Save("a", atlas);
  atlas.maps[1].points.pop_back();
  atlas.maps[1].points[0].position.y() = std::numeric_limits<float>::quiet_NaN();
  store.Save("a", atlas);
  EXPECT_EQ(Sql(folder / "s.db", "SELECT rtreecheck('map_point_box')"), "ok");
  EXPECT_EQ(Sql(folder / "s.db", "SELECT count(*) FROM map_point_box"),
            std::to_string(atlas.maps[0].points.size() + atlas.maps[1].points.size() - 1));
  EXPECT_EQ(FirstDifference(store.Load("a"), atlas), "");
}

TEST(StoreIncremental, ObservationsOfOnePoint) {
  const TemporaryFolder folder;
  Atlas atlas = SoundAtlas();
  SaveIn(folder / "s.db", atlas);
  auto& observations = atlas.maps[0].points[7].observations;
  const std::size_t before = observations.size();
  observations.pop_back();
  const SaveReport report = SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(ChangesOf(report, "observation").deleted, before);
  EXPECT_EQ(ChangesOf(report, "observation").inserted, before - 1);
  EXPECT_EQ(ChangesOf(report, "map_point").updated, 1U);
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "");
}

TEST(StoreIncremental, RemovedMapTakesItsRowsAlong) {
  const TemporaryFolder folder;
  Atlas atlas = SoundAtlas();
  SaveIn(folder / "s.db", atlas);
  atlas.maps.erase(atlas.maps.begin());
  const SaveReport report = SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(ChangesOf(report, "map").deleted, 1U);
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "");
  EXPECT_EQ(Sql(folder / "s.db", "SELECT count(*) FROM map_point"), std::to_string(atlas.maps[0].points.size()));
  EXPECT_EQ(Sql(folder / "s.db", "SELECT count(*) FROM map_point_box"), std::to_string(atlas.maps[0].points.size()));
}

// Any sequence of edits ends in the atlas that was saved last, whatever the rows went through.
TEST(StoreIncremental, RandomEditsAlwaysComeBack) {
  const TemporaryFolder folder;
  Atlas atlas = OddAtlas();
  std::mt19937 random(7);
  const auto pick = [&](std::size_t size) { return static_cast<std::ptrdiff_t>(random() % size); };
  for (int step = 0; step < 40; ++step) {
    Map& map = atlas.maps[random() % atlas.maps.size()];
    switch (random() % 8) {
      case 0:
        if (map.points.size() > 1) map.points.erase(map.points.begin() + pick(map.points.size()));
        break;
      case 1:
        if (!map.points.empty()) map.points.push_back(map.points[random() % map.points.size()]);
        break;
      case 2:
        if (!map.points.empty()) map.points.insert(map.points.begin() + pick(map.points.size()), MapPoint());
        break;
      case 3:
        std::shuffle(map.keyframes.begin(), map.keyframes.end(), random);
        break;
      case 4:
        if (!map.keyframes.empty()) map.keyframes.erase(map.keyframes.begin() + pick(map.keyframes.size()));
        break;
      case 5:
        if (!map.keyframes.empty()) map.keyframes[random() % map.keyframes.size()].id = KeyFrameId(random() % 4);
        break;
      case 6:
        if (!map.points.empty()) map.points[random() % map.points.size()].position.x() += 1;
        break;
      default:
        std::shuffle(atlas.maps.begin(), atlas.maps.end(), random);
    }
    SaveIn(folder / "s.db", atlas);
    ASSERT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "") << "after step " << step;
  }
  // And a store that came about so is as good as a fresh one.
  EXPECT_EQ(Sql(folder / "s.db", "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(Sql(folder / "s.db", "SELECT rtreecheck('map_point_box')"), "ok");
}

}  // namespace
}  // namespace slamdb::store_test
