// SPDX-License-Identifier: BSD-3-Clause
// What aligning sees of maps, sound ones and damaged ones.
#include "slamdb/align/detail/map_views.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <numeric>
#include <set>

#include "slamdb/model/index.h"
#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

using detail::MapViews;
using detail::View;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Atlas OneMap(Sensor sensor = Sensor::kRgbd) {
  SyntheticOptions options{.sensor = sensor};
  options.keyframes = 6;
  options.points = 120;
  options.features = sensor == Sensor::kFisheyeStereo ? 600 : 300;
  return SynthesizeAtlas(options);
}

// Every index is of something, and both directions of sightings agree.
void ExpectWhole(const MapViews& map) {
  std::size_t sightings = 0, seen = 0;
  for (std::uint32_t point = 0; point < map.points().size(); ++point) {
    EXPECT_TRUE(map.points()[point].position.allFinite());
    ASSERT_LT(map.points()[point].row, map.map().points.size());
    for (const detail::Sighting& sighting : map.SightingsOf(point)) {
      ASSERT_LT(sighting.view, map.views().size());
      ASSERT_LT(sighting.keypoint, map.views()[sighting.view].keypoints.size());
      ++sightings;
    }
  }
  for (std::uint32_t view = 0; view < map.views().size(); ++view) {
    const View& each = map.views()[view];
    ASSERT_EQ(each.keypoints.size(), each.descriptors.size());
    EXPECT_TRUE(each.rotation.allFinite() && each.center.allFinite());
    for (const detail::Seen& one : map.SeenBy(view)) {
      ASSERT_LT(one.point, map.points().size());
      EXPECT_NE(map.PointAt({view, one.keypoint}), kNoRow);
      ++seen;
    }
    if (each.right) continue;
    for (const std::uint32_t neighbour : map.BestCovisibles(view, 8)) ASSERT_LT(neighbour, map.views().size());
  }
  EXPECT_EQ(sightings, seen);
}

TEST(MapViews, SeesWhatASoundMapHolds) {
  const Atlas atlas = OneMap();
  const MapViews map(atlas, 0);
  ExpectWhole(map);
  EXPECT_EQ(map.views().size(), 6U);
  EXPECT_EQ(map.points().size(), 120U);
  EXPECT_TRUE(map.metric());
  EXPECT_FALSE(map.up());
  std::size_t observations = 0, sightings = 0;
  for (const MapPoint& point : atlas.maps[0].points) observations += point.observations.size();
  for (std::uint32_t point = 0; point < map.points().size(); ++point) sightings += map.SightingsOf(point).size();
  EXPECT_EQ(sightings, observations);
  EXPECT_NEAR(map.median_depth(), 4, 0.5) << "the wall is 4 m off";
}

TEST(MapViews, AFisheyePairIsTwoViews) {
  const Atlas atlas = OneMap(Sensor::kFisheyeStereo);
  const MapViews map(atlas, 0);
  ExpectWhole(map);
  ASSERT_EQ(map.views().size(), 12U);
  for (std::uint32_t view = 0; view < 12; view += 2) {
    EXPECT_FALSE(map.views()[view].right);
    EXPECT_TRUE(map.views()[view + 1].right);
    EXPECT_EQ(map.LastViewOf(view), view + 1);
    EXPECT_NEAR((map.views()[view].center - map.views()[view + 1].center).norm(), 0.11, 1e-3);
  }
}

TEST(MapViews, CovisiblesShareMostPoints) {
  const Atlas atlas = OneMap();
  const MapViews map(atlas, 0);
  std::vector<int> shared(map.views().size(), 0);
  for (const MapPoint& point : atlas.maps[0].points) {
    std::set<std::uint64_t> rows;
    for (const Observation& observation : point.observations) rows.insert(observation.keyframe.value());
    if (rows.contains(2))
      for (const std::uint64_t row : rows) ++shared[row];
  }
  const std::vector<std::uint32_t> best = map.BestCovisibles(2, 3);
  ASSERT_EQ(best.size(), 3U);
  EXPECT_EQ(std::ranges::find(best, 2U), best.end()) << "a view is not covisible with itself";
  shared[2] = 0;
  EXPECT_EQ(shared[best[0]], *std::ranges::max_element(shared));
  EXPECT_GE(shared[best[0]], shared[best[1]]);
  EXPECT_GE(shared[best[1]], shared[best[2]]);
}

// Damage to a map, and how many of its 6 views and 120 points are left.
struct Damage {
  const char* name;
  std::function<void(Atlas&)> make;
  std::size_t views, points;
};

class DamagedMap : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedMap, KeepsWhatHolds) {
  Atlas atlas = OneMap();
  GetParam().make(atlas);
  const MapViews map(atlas, 0);
  ExpectWhole(map);
  EXPECT_EQ(map.views().size(), GetParam().views);
  EXPECT_EQ(map.points().size(), GetParam().points);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, DamagedMap,
    ::testing::Values(
        Damage{"PoseOfNan", [](Atlas& a) { a.maps[0].keyframes[1].camera_from_world.translation.x() = kNan; }, 5, 120},
        Damage{"RotationOfZeros",
               [](Atlas& a) { a.maps[0].keyframes[1].camera_from_world.rotation.coeffs().setZero(); }, 5, 120},
        Damage{"PointAtNan", [](Atlas& a) { a.maps[0].points[7].position.y() = kNan; }, 6, 119},
        Damage{"BadKeyFrame", [](Atlas& a) { a.maps[0].keyframes[5].bad = Flag(true); }, 5, 120},
        Damage{"BadPoint", [](Atlas& a) { a.maps[0].points[3].bad = Flag(true); }, 6, 119},
        Damage{"NoCameras", [](Atlas& a) { a.cameras.clear(); }, 0, 120},
        Damage{"CameraOfNan", [](Atlas& a) { a.cameras[0].parameters[0] = kNan; }, 0, 120},
        Damage{"CameraOfTwoNumbers", [](Atlas& a) { a.cameras[0].parameters.resize(2); }, 0, 120},
        Damage{"DanglingObserver", [](Atlas& a) { a.maps[0].points[0].observations[0].keyframe = KeyFrameId(999); }, 6,
               120},
        Damage{"SlotBeyondColumns",
               [](Atlas& a) { a.maps[0].points[0].observations[0].left = std::numeric_limits<std::int32_t>::max(); }, 6,
               120},
        Damage{"SlotBelowZero", [](Atlas& a) { a.maps[0].points[0].observations[0].left = -77; }, 6, 120},
        Damage{"DanglingReference", [](Atlas& a) { a.maps[0].points[0].reference = KeyFrameId(999); }, 6, 120},
        Damage{"NoDescriptors", [](Atlas& a) { a.maps[0].keyframes[2].features.descriptors.clear(); }, 6, 120},
        Damage{"FewerDescriptors", [](Atlas& a) { a.maps[0].keyframes[2].features.descriptors.resize(10); }, 6, 120},
        Damage{"NoKeypoints", [](Atlas& a) { a.maps[0].keyframes[2].features.undistorted.clear(); }, 6, 120},
        Damage{"KeypointsOfNan",
               [](Atlas& a) {
                 for (Keypoint& k : a.maps[0].keyframes[2].features.undistorted) k.x = kNan;
               },
               6, 120},
        Damage{"KeypointFarOff", [](Atlas& a) { a.maps[0].keyframes[2].features.undistorted[0].x = 3e38F; }, 6, 120},
        Damage{"OctaveFarOff", [](Atlas& a) { a.maps[0].keyframes[2].features.undistorted[0].octave = 1 << 30; }, 6,
               120},
        Damage{"ManyLevels", [](Atlas& a) { a.maps[0].keyframes[2].pyramid.levels = 1 << 30; }, 6, 120},
        Damage{"NoBounds", [](Atlas& a) { a.maps[0].keyframes[2].bounds = {}; }, 6, 120},
        Damage{"NoPoints", [](Atlas& a) { a.maps[0].points.clear(); }, 6, 0},
        Damage{"NoKeyFrames", [](Atlas& a) { a.maps[0].keyframes.clear(); }, 0, 120}),
    [](const auto& damage) { return damage.param.name; });

TEST(KeypointCells, VisitsAllThatAreNearAndNoOther) {
  const Atlas atlas = OneMap();
  const Column<Keypoint>& keypoints = atlas.maps[0].keyframes[0].features.undistorted;
  const detail::KeypointCells cells{std::span(keypoints)};
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(320, 240), Eigen::Vector2d(0, 0), Eigen::Vector2d(639, 10),
                                       Eigen::Vector2d(-500, 100), Eigen::Vector2d(1e9, 1e9)})
    for (const double radius : {3.0, 40.0, 1000.0}) {
      std::set<std::uint32_t> found, expected;
      cells.VisitNear(place, radius, [&](std::uint32_t row) { EXPECT_TRUE(found.insert(row).second); });
      for (std::uint32_t row = 0; row < keypoints.size(); ++row)
        if (std::abs(static_cast<double>(keypoints[row].x) - place.x()) < radius &&
            std::abs(static_cast<double>(keypoints[row].y) - place.y()) < radius)
          expected.insert(row);
      EXPECT_EQ(found, expected) << place.transpose() << " " << radius;
    }
}

}  // namespace
}  // namespace slamdb::testing
