// SPDX-License-Identifier: BSD-3-Clause
// Landmarks of three atlases, of which ids tell what is what.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"
#include "tests/edit/merge/branched.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Atlas WithLandmarks(Atlas atlas, const std::vector<std::pair<std::uint64_t, double>>& landmarks,
                    std::uint64_t map = 9) {
  Map& held = atlas.maps.emplace_back();
  held.id = MapId(map);
  for (const auto& [id, x] : landmarks) held.landmarks.push_back({.id = LandmarkId(id), .mean = {x, 0, 0}});
  RaiseCounters(atlas);
  return atlas;
}
std::multiset<double> LandmarksOf(const Atlas& atlas) {
  std::multiset<double> all;
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks) all.insert(landmark.mean.x());
  return all;
}

TEST(ThreeWayLandmarks, AreAsTheSideHasThemThatChangedThem) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = WithLandmarks(branched.base, {{9001, 1}, {9002, 2}, {9003, 3}, {9004, 4}, {9005, 5}});
  const Atlas ours = WithLandmarks(branched.ours, {{9001, 1}, {9002, 2.5}, {9003, 3}, {9005, 5.5}, {9006, 60}});
  const Atlas theirs = WithLandmarks(branched.theirs, {{9001, 1}, {9002, 2}, {9003, 3.5}, {9004, 4}, {9006, 61}}, 12);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, theirs, ours) : MergeThreeWays(base, ours, theirs);
    EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{1, 2.5, 3.5, 5.5, 60, 61})) << swapped;
    std::vector<std::string> conflicts;
    for (const BranchConflict& conflict : merged.report.conflicts)
      if (conflict.place.landmark) conflicts.push_back(MessageOf(conflict));
    EXPECT_THAT(conflicts, ElementsAre(swapped ? "deleted by ours, extended by theirs: kept"
                                               : "deleted by theirs, extended by ours: kept"));
    EXPECT_THAT(merged.atlas.maps, SizeIs(2));
  }
}

TEST(ThreeWayLandmarks, OfAMapThatTheOtherDeletedStayWhereTheyChanged) {
  const Branched branched = Branch(kWorlds[4]);
  const auto with = [](const Atlas& atlas, const std::vector<std::pair<std::uint64_t, double>>& landmarks) {
    return WithLandmarks(WithLandmarks(atlas, {{8001, 8}}, 8), landmarks);
  };
  const Atlas base = with(branched.base, {{9001, 1}}), same = with(branched.ours, {{9001, 1}}),
              more = with(branched.ours, {{9001, 1}, {9002, 2}}), gone = WithLandmarks(branched.theirs, {{8001, 8}}, 8);
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, same, gone).atlas), (std::multiset<double>{8}));
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, more, gone).atlas), (std::multiset<double>{1, 2, 8}));
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, gone, more).atlas), (std::multiset<double>{1, 2, 8}));
}

// Of the first map.
Atlas WithOwnLandmarks(Atlas atlas, const std::vector<Landmark>& landmarks) {
  atlas.maps[0].landmarks = landmarks;
  RaiseCounters(atlas);
  return atlas;
}
Landmark LandmarkAt(std::uint64_t id, const Eigen::Vector3d& mean) { return {.id = LandmarkId(id), .mean = mean}; }

// As a robot has it that comes back by an .osa file.
TEST(ThreeWayLandmarks, WhatAFormatHasNoPlaceForIsNotDeleted) {
  const Branched branched = Branch(kWorlds[4]);
  Atlas base = WithLandmarks(WithOwnLandmarks(branched.base, {LandmarkAt(9001, {1, 0, 0})}), {{9002, 2}});
  Atlas ours = WithLandmarks(WithOwnLandmarks(branched.ours, {LandmarkAt(9001, {1.5, 0, 0})}), {{9002, 2}});
  for (Atlas* atlas : {&base, &ours})
    for (MapPoint& point : atlas->maps[0].points) {
      point.origin_map = 0;
      point.visible_count = point.found_count = 7;
    }
  const AtlasIndex index(base);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged =
        swapped ? MergeThreeWays(base, branched.theirs, ours) : MergeThreeWays(base, ours, branched.theirs);
    EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{1.5, 2})) << swapped;
    EXPECT_THAT(merged.report.warnings, ElementsAre(HasSubstr("has no landmarks, as an .osa file has none")));
    const IdTable points = PointTable(merged.atlas.maps[0]);
    for (const MapPoint& before : ours.maps[0].points) {
      if (!index.LocatePoint(before.id)) continue;
      const MapPoint& after = merged.atlas.maps[0].points.at(points.Find(before.id.value()));
      EXPECT_EQ(after.origin_map, 0U);
      EXPECT_EQ(after.visible_count, 7);
    }
  }
}

// Also where one side alone has gone on.
TEST(ThreeWayLandmarks, OfASideThatWentOnAloneAreThoseOfTheBase) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = WithLandmarks(branched.base, {{9001, 1}});
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged =
        swapped ? MergeThreeWays(base, branched.theirs, base) : MergeThreeWays(base, base, branched.theirs);
    EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{1})) << swapped;
    EXPECT_EQ(merged.atlas.maps[0].keyframes.size(), kOld + kNew);
    EXPECT_THAT(merged.report.conflicts, IsEmpty());
  }
}

// Those of a side that is laid onto the other go with its points.
TEST(ThreeWayLandmarks, GoWithTheMapThatIsBent) {
  const Branched branched = Branch(kWorlds[4]);
  const MapPoint& point = branched.base.maps[0].points[3];
  const std::vector<Landmark> landmarks = {LandmarkAt(point.id.value(), point.position.cast<double>()),
                                           LandmarkAt(9001, {0.2, 0.1, 0.3})};
  const Atlas base = WithOwnLandmarks(branched.base, landmarks);
  Atlas ours = WithOwnLandmarks(branched.ours, landmarks), theirs = WithOwnLandmarks(branched.theirs, landmarks);
  theirs.maps[0].landmarks.push_back(LandmarkAt(9002, {0.4, 0, 0}));
  RaiseCounters(theirs);
  TransformMap(theirs.maps[0], {1, Eigen::Quaterniond::Identity(), {0.05, 0, 0}}, 1);
  const ThreeWayResult merged = MergeThreeWays(base, ours, theirs, {.geometry = BranchGeometry::kOurs});
  ASSERT_THAT(merged.atlas.maps[0].landmarks, SizeIs(3));
  EXPECT_LT((merged.atlas.maps[0].landmarks[0].mean - landmarks[0].mean).norm(), 1e-4);
  EXPECT_LT((merged.atlas.maps[0].landmarks[1].mean - landmarks[1].mean).norm(), 1e-4);
  EXPECT_LT((merged.atlas.maps[0].landmarks[2].mean - Eigen::Vector3d(0.4, 0, 0)).norm(), 1e-4);
}

// Wherever the merge puts these.
TEST(ThreeWayLandmarks, StayAtTheirPoints) {
  const Branched branched = Branch(kWorlds[4]);
  const MapPointId id = branched.base.maps[0].points[3].id;
  const auto with = [&](Atlas atlas, float shift, std::uint32_t seen) {
    MapPoint& point = atlas.maps[0].points.at(PointTable(atlas.maps[0]).Find(id.value()));
    point.position.x() += shift;
    Landmark landmark = LandmarkAt(id.value(), point.position.cast<double>() + Eigen::Vector3d(0, 0.25, 0));
    landmark.seen_count = seen;
    return WithOwnLandmarks(atlas, {landmark});
  };
  const Atlas base = with(branched.base, 0, 1), ours = with(branched.ours, 0, 2),
              theirs = with(branched.theirs, 0.5, 1);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, theirs, ours) : MergeThreeWays(base, ours, theirs);
    const Map& map = merged.atlas.maps[0];
    const Eigen::Vector3d place = map.points.at(PointTable(map).Find(id.value())).position.cast<double>();
    EXPECT_GT(place.x(), base.maps[0].points[3].position.x() + 0.1);
    ASSERT_THAT(map.landmarks, SizeIs(1));
    EXPECT_LT((map.landmarks[0].mean - place - Eigen::Vector3d(0, 0.25, 0)).norm(), 1e-5) << swapped;
  }
}

TEST(ThreeWayLandmarks, OfPointsThatASideFusedBecomeOne) {
  const Branched branched = Branch(kWorlds[4]);
  const auto all = [](Atlas atlas) {
    for (const MapPoint& point : atlas.maps[0].points)
      atlas.maps[0].landmarks.push_back(LandmarkAt(point.id.value(), point.position.cast<double>()));
    return atlas;
  };
  const Atlas base = all(branched.base), theirs = all(branched.theirs);
  Atlas ours = branched.ours;
  const MapPointId gone = branched.base.maps[0].points[3].id;
  ASSERT_EQ(FusePairs(ours.maps[0], {{NeverSeenWith(gone, branched), gone}}).fused, 1U);
  ours = all(ours);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, theirs, ours) : MergeThreeWays(base, ours, theirs);
    const Map& map = merged.atlas.maps[0];
    std::set<std::uint64_t> points, landmarks;
    for (const MapPoint& point : map.points) points.insert(point.id.value());
    for (const Landmark& landmark : map.landmarks) landmarks.insert(landmark.id.value());
    EXPECT_EQ(points, landmarks) << swapped;
    EXPECT_EQ(map.landmarks.size(), landmarks.size());
  }
}

TEST(ThreeWayLandmarks, OrEdgesKeepAMapThatTheOtherDeleted) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas other = MakeWorld(kWorlds[4], 1, 77);
  const auto with = [&](const Atlas& side) { return MergeAtlases({side, other}).atlas; };
  const Atlas base = with(branched.base);
  Atlas marked = with(branched.ours), tied = marked;
  marked.maps[1].landmarks.push_back(LandmarkAt(90001, {1, 0, 0}));
  RaiseCounters(marked);
  tied.maps[1].keyframes[0].loop_edges.push_back(tied.maps[1].keyframes[9].id);
  tied.maps[1].keyframes[9].loop_edges.push_back(tied.maps[1].keyframes[0].id);
  for (const Atlas& ours : {marked, tied}) {
    const ThreeWayResult merged = MergeThreeWays(base, ours, branched.theirs);
    EXPECT_THAT(merged.atlas.maps, SizeIs(2));
    ASSERT_THAT(merged.report.conflicts, SizeIs(1));
    EXPECT_EQ(merged.report.conflicts[0].place.map, ours.maps[1].id);
    EXPECT_THAT(MergeThreeWays(base, branched.theirs, ours).atlas.maps, SizeIs(2));
  }
}

TEST(ThreeWayLandmarks, WithoutIdsAreThoseOfTheSameContent) {
  const Branched branched = Branch(kWorlds[4]);
  const auto some = [](const std::vector<double>& places) {
    std::vector<Landmark> landmarks;
    for (const double x : places) landmarks.push_back({.mean = {x, 0, 0}});
    return landmarks;
  };
  const Atlas base = WithOwnLandmarks(branched.base, some({1, 2, 2, 3})),
              ours = WithOwnLandmarks(branched.ours, some({1, 2, 2, 4})),
              theirs = WithOwnLandmarks(branched.theirs, some({2, 2, 3, 5}));
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, ours, theirs).atlas), (std::multiset<double>{2, 2, 4, 5}));
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, theirs, ours).atlas), (std::multiset<double>{2, 2, 4, 5}));
}

// As each map of a file of MRPT counts from 0.
TEST(ThreeWayLandmarks, OfMapsThatCountAlikeStayInTheirs) {
  const Branched branched = Branch(kWorlds[4]);
  const auto with = [](const Atlas& atlas, double x) {
    return WithLandmarks(WithLandmarks(atlas, {{9000, 1}, {9001, 2}}, 9), {{9000, 3}, {9001, x}}, 10);
  };
  const ThreeWayResult merged =
      MergeThreeWays(with(branched.base, 4), with(branched.ours, 4), with(branched.theirs, 4.5));
  EXPECT_THAT(merged.atlas.maps, SizeIs(3));
  EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{1, 2, 3, 4.5}));
}

TEST(ThreeWayLandmarks, OfMapsThatCountAlikeStayInTheirsWhateverElseTellsThem) {
  const Branched branched = Branch(kWorlds[4]);
  const auto with = [](const Atlas& atlas, const std::vector<std::pair<std::uint64_t, double>>& first) {
    return WithLandmarks(WithLandmarks(atlas, first, 9), {{9000, 3}, {9001, 4}}, 10);
  };
  const Atlas base = with(branched.base, {{9000, 0}, {9001, 1}, {9002, 2}}),
              fewer = with(branched.ours, {{9000, 0}, {9001, 1}}),
              more = with(branched.theirs, {{9000, 0}, {9001, 1}, {9002, 2}, {9050, 50}});
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, more, fewer) : MergeThreeWays(base, fewer, more);
    ASSERT_THAT(merged.atlas.maps, SizeIs(3));
    EXPECT_EQ(merged.atlas.maps[1].id, MapId(9));
    EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{0, 1, 3, 4, 50})) << swapped;
    EXPECT_THAT(merged.report.conflicts, IsEmpty());
  }
}

TEST(ThreeWayLandmarks, OfOneIdAreAllThere) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = WithLandmarks(branched.base, {{9001, 1}}), ours = WithLandmarks(branched.ours, {{9001, 1}}),
              theirs = WithLandmarks(branched.theirs, {{9001, 1}, {9001, 2}});
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, ours, theirs).atlas), (std::multiset<double>{1, 2}));
  EXPECT_EQ(LandmarksOf(MergeThreeWays(base, theirs, ours).atlas), (std::multiset<double>{1, 2}));
}

TEST(ThreeWayLandmarks, OfBothAreThereOnceHoweverOftenTheyAreMerged) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = WithLandmarks(branched.base, {{9001, 1}}),
              ours = WithLandmarks(branched.ours, {{9001, 1}, {9002, 2}}),
              theirs = WithLandmarks(branched.theirs, {{9001, 1}, {9002, 3}});
  const ThreeWayOptions options{.take_containing = false};
  Atlas merged = MergeThreeWays(base, ours, theirs, options).atlas;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(LandmarksOf(merged), (std::multiset<double>{1, 2, 3}));
    merged = MergeThreeWays(base, merged, theirs, options).atlas;
  }
}

TEST(ThreeWayLandmarks, OfARenumberedSideAreRecognised) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = WithLandmarks(branched.base, {{9001, 1}, {9002, 2}}),
              ours = WithLandmarks(branched.ours, {{9002, 2}});
  Atlas theirs = WithLandmarks(branched.theirs, {{9001, 1}, {9002, 2}, {9003, 3}});
  ApplyIdMap(theirs, PlanRenumbering(theirs, {.start = 50000}));
  const ThreeWayResult merged = MergeThreeWays(base, ours, theirs);
  EXPECT_EQ(LandmarksOf(merged.atlas), (std::multiset<double>{2, 3}));
  EXPECT_THAT(merged.report.conflicts, IsEmpty());
}

// Though that moved them.
TEST(ThreeWayLandmarks, OfMapsThatASideJoinedAreDeletedAllTheSame) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas other = MakeWorld(kWorlds[4], 1, 77);
  Atlas base = MergeAtlases({branched.base, other}).atlas, ours = MergeAtlases({branched.ours, other}).atlas;
  for (Atlas* atlas : {&base, &ours}) {
    atlas->maps[1].landmarks = {LandmarkAt(90001, {1, 0, 0}), LandmarkAt(90002, {2, 0, 0})};
    RaiseCounters(*atlas);
  }
  Atlas theirs = base;
  const Similarity3d placed{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY())), {3, 0, 1}};
  JoinMaps(theirs, {.first = base.maps[0].id, .second = base.maps[1].id, .first_from_second = placed});
  ours.maps[1].landmarks.erase(ours.maps[1].landmarks.begin());
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, theirs, ours) : MergeThreeWays(base, ours, theirs);
    ASSERT_THAT(merged.atlas.maps, SizeIs(1));
    ASSERT_THAT(merged.atlas.maps[0].landmarks, SizeIs(1)) << swapped;
    EXPECT_EQ(merged.atlas.maps[0].landmarks[0].id, LandmarkId(90002));
    EXPECT_LT((merged.atlas.maps[0].landmarks[0].mean - placed * Eigen::Vector3d(2, 0, 0)).norm(), 1e-4);
    EXPECT_THAT(merged.report.conflicts, IsEmpty());
  }
}

}  // namespace
}  // namespace slamdb
