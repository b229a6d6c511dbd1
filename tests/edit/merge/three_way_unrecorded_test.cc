// SPDX-License-Identifier: BSD-3-Clause
// Sides that come back by a format which has no place for all that the base has.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/detail/carried_members.h"
#include "slamdb/model/digest.h"
#include "tests/edit/merge/branched.h"

namespace slamdb {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kFork = "fork";

void SetMembers(Boxed<Carried>& carried, std::size_t value) { carried.Make().members.assign(1, std::byte(value)); }

// Of everything that no .osa file of ORB-SLAM3 v1.0 has.
Atlas WithEverything(Atlas atlas) {
  atlas.layout = kFork;
  SetMembers(atlas.carried, 1);
  Map& map = atlas.maps[0];
  SetMembers(map.carried, 2);
  for (KeyFrame& keyframe : map.keyframes) SetMembers(keyframe.carried, keyframe.id.value());
  for (MapPoint& point : map.points) {
    SetMembers(point.carried, point.id.value());
    point.origin_map = 0;
    point.visible_count = 9;
    point.found_count = 7;
    map.landmarks.push_back({.id = LandmarkId(point.id.value()), .mean = point.position.cast<double>()});
  }
  RaiseCounters(atlas);
  return atlas;
}

// As such a file holds it.
Atlas Plain(Atlas atlas) {
  atlas.layout.clear();
  detail::ForEachCarried(atlas, [](Boxed<Carried>& carried) { detail::DropMembers(carried); });
  for (Map& map : atlas.maps) {
    map.landmarks.clear();
    for (MapPoint& point : map.points) {
      point.origin_map = MapPoint::kNoOrigin;
      point.visible_count = point.found_count = MapPoint::kNoCount;
    }
  }
  return atlas;
}

// Whether what the result has of the base still has everything, landmarks at their points.
void ExpectEverythingOf(const Atlas& base, const Atlas& result) {
  const AtlasIndex index(result);
  EXPECT_EQ(result.layout, kFork);
  EXPECT_TRUE(detail::HasMembers(result.carried));
  EXPECT_TRUE(detail::HasMembers(result.maps[0].carried));
  std::size_t keyframes = 0, points = 0;
  for (const KeyFrame& before : base.maps[0].keyframes)
    if (const EntityRow place = index.LocateKeyFrame(before.id)) {
      EXPECT_EQ(result.maps[place.map].keyframes[place.row].carried, before.carried);
      ++keyframes;
    }
  const auto landmark_of = [&](const Map& map, MapPointId id) {
    return std::ranges::find(map.landmarks, LandmarkId(id.value()), &Landmark::id);
  };
  for (const MapPoint& before : base.maps[0].points)
    if (const EntityRow place = index.LocatePoint(before.id)) {
      const Map& map = result.maps[place.map];
      const MapPoint& now = map.points[place.row];
      EXPECT_EQ(now.carried, before.carried);
      EXPECT_EQ(now.origin_map, before.origin_map);
      EXPECT_EQ(now.visible_count, before.visible_count);
      EXPECT_EQ(now.found_count, before.found_count);
      const auto landmark = landmark_of(map, now.id);
      ASSERT_NE(landmark, map.landmarks.end());
      EXPECT_LT((landmark->mean - now.position.cast<double>()).norm(), 1e-5);
      ++points;
    }
  for (const Landmark& landmark : result.maps[0].landmarks)
    EXPECT_TRUE(index.LocatePoint(MapPointId(landmark.id.value()))) << "its point is gone";
  EXPECT_GT(keyframes, kOld / 2);
  EXPECT_GT(points, 50U);
}

class ThreeWayUnrecorded : public ::testing::Test {
 protected:
  const Branched branched_ = Branch(kWorlds[4]);
  const Atlas base_ = WithEverything(branched_.base);
};

TEST_F(ThreeWayUnrecorded, IsNoDeletionInEitherSideOrBoth) {
  const Atlas ours = Plain(branched_.ours), theirs = Plain(branched_.theirs);
  for (const Atlas& other : {theirs, WithEverything(branched_.theirs)})
    for (const bool swapped : {false, true}) {
      const ThreeWayResult merged = swapped ? MergeThreeWays(base_, other, ours) : MergeThreeWays(base_, ours, other);
      ExpectEverythingOf(base_, merged.atlas);
      EXPECT_EQ(merged.report.dropped_members, (std::array<std::uint64_t, 2>{}));
      EXPECT_THAT(merged.report.warnings, Contains(HasSubstr("has no landmarks, as an .osa file has none")));
    }
}

// Of a side in the layout of another fork the base's members are unchanged, too; its own are named.
TEST_F(ThreeWayUnrecorded, MembersAreNoDeletionInAnotherLayout) {
  Atlas foreign = Plain(branched_.theirs);
  foreign.layout = "another";
  const Atlas ours = WithEverything(branched_.ours);
  for (const bool has_members : {false, true}) {
    if (has_members) SetMembers(foreign.maps[0].keyframes[0].carried, 77);
    for (const bool swapped : {false, true}) {
      const ThreeWayResult merged =
          swapped ? MergeThreeWays(base_, foreign, ours) : MergeThreeWays(base_, ours, foreign);
      ExpectEverythingOf(base_, merged.atlas);
      EXPECT_EQ(merged.report.dropped_members[swapped ? 0 : 1], has_members ? 1U : 0U);
      EXPECT_EQ(merged.report.dropped_members[swapped ? 1 : 0], 0U);
    }
  }
}

// Where the base has none, and one side alone, whichever that is.
TEST_F(ThreeWayUnrecorded, MembersOfOneSideStay) {
  const Atlas mine = WithEverything(branched_.ours);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(branched_.base, branched_.theirs, mine)
                                          : MergeThreeWays(branched_.base, mine, branched_.theirs);
    EXPECT_EQ(merged.atlas.layout, kFork) << swapped;
    EXPECT_EQ(merged.report.dropped_members, (std::array<std::uint64_t, 2>{}));
    const auto with_members = std::ranges::count_if(
        merged.atlas.maps[0].keyframes, [](const KeyFrame& each) { return detail::HasMembers(each.carried); });
    EXPECT_GE(with_members, static_cast<std::ptrdiff_t>(kNew)) << swapped;
  }
}

TEST_F(ThreeWayUnrecorded, ASideThatAloneWentOnIsTheResultAsItIs) {
  const Atlas side = Plain(branched_.theirs);
  for (const Atlas& other : {base_, Plain(base_), side})
    for (const bool swapped : {false, true}) {
      const ThreeWayResult merged = swapped ? MergeThreeWays(base_, side, other) : MergeThreeWays(base_, other, side);
      ExpectEverythingOf(base_, merged.atlas);
      EXPECT_EQ(HashOf(Plain(merged.atlas)), HashOf(side)) << swapped;
      EXPECT_THAT(merged.report.conflicts, IsEmpty());
    }
}

TEST_F(ThreeWayUnrecorded, TheBaseThroughSuchAFileIsTheBase) {
  const Atlas ours = WithEverything(branched_.ours);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged =
        swapped ? MergeThreeWays(base_, Plain(base_), ours) : MergeThreeWays(base_, ours, Plain(base_));
    EXPECT_EQ(merged.report.unchanged, swapped ? BranchSide::kOurs : BranchSide::kTheirs);
    EXPECT_EQ(HashOf(merged.atlas), HashOf(ours)) << swapped;
  }
}

TEST_F(ThreeWayUnrecorded, LandmarksGoAlongIntoAnotherFrame) {
  Atlas side = Plain(branched_.theirs);
  TransformMap(side.maps[0], {1, Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ())), {3, 2, 1}}, 1);
  for (const Atlas& other : {base_, WithEverything(branched_.ours)})
    for (const bool swapped : {false, true})
      ExpectEverythingOf(base_,
                         (swapped ? MergeThreeWays(base_, side, other) : MergeThreeWays(base_, other, side)).atlas);
}

// A map of landmarks alone, which ORB-SLAM3 does not write, is nobody's deletion either.
TEST_F(ThreeWayUnrecorded, AMapOfLandmarksAloneStays) {
  Atlas base = branched_.base;
  Map& cloud = base.maps.emplace_back();
  cloud.id = MapId(7);
  cloud.landmarks.push_back({.id = LandmarkId(5), .mean = {1, 2, 3}});
  RaiseCounters(base);
  for (const Atlas& ours : {branched_.ours, branched_.base}) {
    const ThreeWayResult merged = MergeThreeWays(base, ours, branched_.theirs, {.id_maps = true});
    ASSERT_EQ(merged.atlas.maps.size(), 2U);
    ASSERT_EQ(merged.atlas.maps[1].landmarks.size(), 1U);
    EXPECT_EQ(merged.atlas.maps[1].landmarks[0].mean, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(merged.report.id_maps[0][IdKind::kMap].size(), 1U) << "of what ours has";
    EXPECT_EQ(merged.report.id_maps[1][IdKind::kMap].size(), 1U) << "of what theirs has";
  }
}

// Landmarks of points that are far from each other, and become one.
TEST_F(ThreeWayUnrecorded, LandmarksOfFusedPointsLieAtThePointThatIsLeft) {
  const MapPointId gone = branched_.base.maps[0].points[3].id, left = NeverSeenWith(gone, branched_);
  const auto apart = [&](Atlas atlas) {
    for (MapPoint& point : atlas.maps[0].points)
      if (point.id == gone) point.position.x() += 0.8F;
    return atlas;
  };
  const Atlas base = apart(branched_.base), theirs = apart(branched_.theirs);
  Atlas ours = apart(branched_.ours);
  ASSERT_EQ(FusePairs(ours.maps[0], {{left, gone}}).fused, 1U);
  const auto with_landmarks = [](Atlas atlas) {
    for (const MapPoint& point : atlas.maps[0].points)
      atlas.maps[0].landmarks.push_back({.id = LandmarkId(point.id.value()), .mean = point.position.cast<double>()});
    RaiseCounters(atlas);
    return atlas;
  };
  const Atlas both = with_landmarks(base), other = with_landmarks(theirs);
  for (const Atlas& mine : {ours, with_landmarks(ours)}) {
    const ThreeWayResult result = MergeThreeWays(both, mine, other);
    EXPECT_THAT(result.report.fused, Contains(AnyOf(std::pair(gone, left), std::pair(left, gone))));
    const Map& merged = result.atlas.maps[0];
    const IdTable points = PointTable(merged);
    for (const Landmark& landmark : merged.landmarks)
      if (const std::uint32_t row = points.Find(landmark.id.value()); row != kNoRow) {
        EXPECT_LT((landmark.mean - merged.points[row].position.cast<double>()).norm(), 2e-2) << landmark.id.value();
      }
  }
}

}  // namespace
}  // namespace slamdb
