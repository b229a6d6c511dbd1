// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/cull.h"

#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/base/error.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

// A monocular map of `keyframes` keyframes with ten points each, all of which all of them see; keypoint i of each is
// point i, on octave 0.
Atlas CrowdedMap(std::size_t keyframes) {
  constexpr std::size_t kPoints = 10;
  Atlas atlas;
  Camera& camera = atlas.cameras.emplace_back();
  camera.id = CameraId(0);
  camera.parameters = {500, 500, 320, 240};
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  map.first_keyframe = map.initial_keyframe = map.lowest_keyframe = KeyFrameId(0);
  for (std::uint64_t p = 0; p < kPoints; ++p) {
    MapPoint& point = map.points.emplace_back();
    point.id = MapPointId(p);
    point.position = {0.1F * static_cast<float>(p), 0, 10};
    point.reference = KeyFrameId(0);
    point.observation_count = static_cast<std::int32_t>(keyframes);
  }
  for (std::uint64_t k = 0; k < keyframes; ++k) {
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(k);
    keyframe.timestamp = static_cast<double>(k);
    keyframe.camera = CameraId(0);
    keyframe.camera_from_world.translation.x() = -0.1F * static_cast<float>(k);
    keyframe.pyramid = {.levels = 2, .factor = 2, .factors = {1, 2}};
    if (k > 0) keyframe.parent = KeyFrameId(0);
    keyframe.features.count = kPoints;
    for (MapPoint& point : map.points) {
      const float x = 500 * (point.position.x() - 0.1F * static_cast<float>(k)) / 10 + 320;
      keyframe.features.undistorted.push_back({.size = 31, .x = x, .y = 240, .class_id = -1, .octave = 0});
      keyframe.features.map_points.push_back(point.id);
      keyframe.features.right_x.push_back(-1);
      point.observations.push_back({keyframe.id, static_cast<std::int32_t>(point.id.value()), -1});
    }
  }
  return atlas;
}

std::vector<std::uint64_t> KeyFramesAfter(Atlas atlas, const CullOptions& options) {
  Cull(atlas, options);
  std::vector<std::uint64_t> ids;
  for (const KeyFrame& keyframe : atlas.maps.at(0).keyframes) ids.push_back(keyframe.id.value());
  return ids;
}

// A keyframe without its point `p`.
void Forget(Atlas& atlas, std::size_t keyframe, std::size_t p) {
  Map& map = atlas.maps[0];
  map.keyframes[keyframe].features.map_points[p] = {};
  std::erase_if(map.points[p].observations,
                [&](const Observation& o) { return o.keyframe == map.keyframes[keyframe].id; });
  --map.points[p].observation_count;
}

using Ids = std::vector<std::uint64_t>;

TEST(CullKeyFrames, UntilThreeOthersAreLeft) {
  EXPECT_EQ(KeyFramesAfter(CrowdedMap(6), {.redundancy = 0.9}), (Ids{0, 4, 5}));
  EXPECT_EQ(KeyFramesAfter(CrowdedMap(6), {.redundancy = 0.9, .redundant_observers = 4}), (Ids{0, 3, 4, 5}));
  EXPECT_EQ(KeyFramesAfter(CrowdedMap(4), {.redundancy = 0.9}), (Ids{0, 2, 3}));
  EXPECT_EQ(KeyFramesAfter(CrowdedMap(3), {.redundancy = 0.9}), (Ids{0, 1, 2}));
}

TEST(CullKeyFrames, NeedsMoreThanTheShare) {
  // Of ten points of keyframe 1, one is only seen by it and two others: 9 of 10 is not more than 0.9.
  Atlas atlas = CrowdedMap(4);
  for (const std::size_t keyframe : {3}) Forget(atlas, keyframe, 0);
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.9}), Contains(1U));
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.89}), Not(Contains(1U)));
}

TEST(CullKeyFrames, OthersMustSeeAtTheSameScaleOrFiner) {
  Atlas atlas = CrowdedMap(4);
  for (Keypoint& keypoint : atlas.maps[0].keyframes[3].features.undistorted) keypoint.octave = 2;
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.9}), Contains(1U));
  for (Keypoint& keypoint : atlas.maps[0].keyframes[3].features.undistorted) keypoint.octave = 1;
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.9}), Not(Contains(1U)));
}

TEST(CullKeyFrames, SparesThoseWithEdges) {
  Atlas atlas = CrowdedMap(5);
  atlas.maps[0].keyframes[1].not_erase = true;
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.9}), Contains(1U));
}

TEST(CullKeyFrames, LooksAtClosePointsOfDepthOnly) {
  // Every keyframe measures depth; nine points are far. The close one is seen by all others.
  Atlas atlas = CrowdedMap(5);
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    keyframe.intrinsics.depth_threshold = 4;
    keyframe.features.right_x.assign(10, 5.0F);
    keyframe.features.depth.assign(10, 9.0F);
    keyframe.features.depth[0] = 2;
  }
  for (std::size_t p = 1; p < 10; ++p)
    for (const std::size_t keyframe : {2, 3, 4}) Forget(atlas, keyframe, p);
  EXPECT_THAT(KeyFramesAfter(atlas, {.redundancy = 0.9}), Not(Contains(1U)));
}

// A map with IMU keeps the gaps short that it integrates over.
TEST(CullKeyFrames, KeepsGapsShortWithImu) {
  const auto inertial = [](double interval) {
    Atlas atlas = CrowdedMap(30);
    Map& map = atlas.maps[0];
    map.inertial = map.imu_initialized = map.imu_ba1 = map.imu_ba2 = true;
    for (std::size_t k = 0; k < 30; ++k) {
      KeyFrame& keyframe = map.keyframes[k];
      keyframe.timestamp = static_cast<double>(k) * interval;
      keyframe.imu_calibration.is_set = true;
      if (k > 0) keyframe.previous = KeyFrameId(k - 1);
      if (k < 29) keyframe.next = KeyFrameId(k + 1);
    }
    return KeyFramesAfter(atlas, {.redundancy = 0.9}).size();
  };
  EXPECT_EQ(inertial(2), 30U);    // every gap would be 4 s
  EXPECT_LT(inertial(0.2), 30U);  // gaps of 0.4 s anywhere, up to 3 s behind the newest 21
  EXPECT_GT(inertial(0.2), 10U);
}

TEST(CullPoints, ByObservations) {
  Atlas atlas = CrowdedMap(5);
  for (const std::size_t keyframe : {1, 2, 3}) Forget(atlas, keyframe, 7);  // 2 observations left
  atlas.maps[0].points[8].first_keyframe = 3;                               // young
  for (const std::size_t keyframe : {0, 1, 2}) Forget(atlas, keyframe, 8);
  atlas.maps[0].points[8].reference = KeyFrameId(3);
  const CullReport report = Cull(atlas, {.min_observations = OfSensor()});
  EXPECT_EQ(report.few_observations, 1U);
  EXPECT_EQ(atlas.maps[0].points.size(), 9U);
  EXPECT_FALSE(atlas.maps[0].keyframes[0].features.map_points[7]);
}

TEST(CullPoints, ByObservationsOnlyWhenAsked) {
  Atlas atlas = CrowdedMap(5);
  atlas.maps[0].points[7].observation_count = -1;  // damaged
  EXPECT_EQ(Cull(atlas, {.max_error = 100}).few_observations, 0U);
  EXPECT_EQ(Cull(atlas, {.min_observations = 0}).few_observations, 1U);
}

TEST(CullPoints, ByReprojectionErrorInPixelsOfTheOctave) {
  Atlas atlas = CrowdedMap(5);
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    keyframe.features.undistorted[3].x += 3;
    keyframe.features.undistorted[4].x += 3;
    keyframe.features.undistorted[4].octave = 1;  // where a pixel is two
  }
  EXPECT_EQ(Cull(atlas, {.max_error = 2.45}).large_errors, 1U);
  EXPECT_EQ(atlas.maps[0].points.size(), 9U);
  EXPECT_EQ(atlas.maps[0].points[3].id, MapPointId(4));
}

TEST(CullPoints, ByParallax) {
  // Centres are 0.4 m apart at most, points 10 m away: 2.3 degrees.
  Atlas atlas = CrowdedMap(5);
  EXPECT_EQ(Cull(atlas, {.min_parallax = 2}).small_parallax, 0U);
  atlas.maps[0].points[5].position = {0, 0, 100};
  atlas.maps[0].points[6].position = {0, 0, 100};
  atlas.maps[0].keyframes[2].features.right_x[6] = 100;  // measured by depth
  EXPECT_EQ(Cull(atlas, {.min_parallax = 2}).small_parallax, 1U);
}

TEST(CullPoints, ByAge) {
  Atlas atlas = CrowdedMap(5);
  Forget(atlas, 4, 2);
  EXPECT_EQ(Cull(atlas, {.unseen_since = 4}).unseen, 1U);
  EXPECT_EQ(Cull(atlas, {.unseen_since = 4}).unseen, 0U);
}

// Every count of the report on its own, so that none can stand for another.
TEST(CullPoints, AreCountedByTheFirstRuleThatTakesThem) {
  Atlas atlas = CrowdedMap(6);
  Map& map = atlas.maps[0];
  map.points[0].bad = true;
  for (const std::size_t point : {1, 2})
    for (const std::size_t keyframe : {1, 2, 3, 4}) Forget(atlas, keyframe, point);  // 2 observations left
  for (KeyFrame& keyframe : map.keyframes)
    for (const std::size_t point : {3, 4, 5}) keyframe.features.undistorted[point].x += 9;
  for (const std::size_t point : {6, 7, 8}) Forget(atlas, 5, point);
  const CullReport report = Cull(atlas, {.min_observations = 3, .max_error = 2.45, .unseen_since = 5});
  EXPECT_EQ(report.bad_points, 1U);
  EXPECT_EQ(report.few_observations, 2U);
  EXPECT_EQ(report.large_errors, 3U);
  EXPECT_EQ(report.small_parallax, 0U);
  EXPECT_EQ(report.unseen, 3U);
  EXPECT_EQ(report.unheld, 0U);
  EXPECT_EQ(report.redundant_keyframes, 0U);
  EXPECT_EQ(report.removed.points, 9U);
  EXPECT_EQ(report.removed.before, (EntityCounts{.maps = 1, .keyframes = 6, .points = 10}));
  EXPECT_EQ(report.removed.after, (EntityCounts{.maps = 1, .keyframes = 6, .points = 1}));
}

TEST(Cull, RefusesRulesThatMakeNoSense) {
  Atlas atlas = CrowdedMap(5);
  const Atlas same = atlas;
  for (const CullOptions& options :
       {CullOptions{.redundancy = 1.5}, CullOptions{.redundancy = 0.9, .redundant_observers = 0},
        CullOptions{.min_observations = -1}, CullOptions{.max_error = 0}, CullOptions{.min_parallax = 180},
        CullOptions{.unseen_since = NAN}})
    EXPECT_EQ(KindOf([&] { Cull(atlas, options); }), ErrorKind::kUsage);
  EXPECT_THAT(atlas, EqualsAtlas(same));
}

void ExpectSound(const Atlas& atlas, const std::string& name) {
  SCOPED_TRACE(name);
  const std::set<std::string> known = Troubles(atlas);
  for (const CullOptions& options : {CullOptions::Orbslam3(), CullOptions{.redundancy = 0.5, .redundant_observers = 1},
                                     CullOptions{.max_error = 1, .min_parallax = 3}}) {
    Atlas culled = atlas, alone = atlas;
    const CullReport report = Cull(culled, options);
    EXPECT_THAT(NewTroubles(known, culled), IsEmpty());
    EXPECT_EQ(report.removed.keyframes, report.redundant_keyframes);
    EXPECT_EQ(report.removed.before, CountEntities(atlas));
    EXPECT_EQ(report.removed.after, CountEntities(culled));
    EXPECT_EQ(report.removed.points, report.bad_points + report.few_observations + report.large_errors +
                                         report.small_parallax + report.unseen + report.unheld);
    EXPECT_LE(report.coverage.covered, report.coverage.covered_before);
    CullOptions on_one_thread = options;
    on_one_thread.threads = 1;
    Cull(alone, on_one_thread);
    EXPECT_THAT(alone, EqualsAtlas(culled));
  }
}

TEST(Cull, LeavesASoundAtlasOfEverySensorKind) {
  for (const SyntheticOptions& kind : SensorKinds()) ExpectSound(SynthesizeAtlas(kind), NameOf(kind));
}

class RealAtlasCulled : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasCulled, IsSound) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  ExpectSound(ReadOrbslam3(path, {}, notices), GetParam());
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasCulled,
                         ::testing::Values("stereo_inertial", "fisheye_stereo", "multimap_rgbd", "race_mono"));

}  // namespace
}  // namespace slamdb::testing
