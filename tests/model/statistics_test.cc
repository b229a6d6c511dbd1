// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/statistics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/model/summary.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Keypoint KeypointAt(float x, float y) {
  return {.angle = 0, .response = 0, .size = 31, .x = x, .y = y, .class_id = -1, .octave = 0};
}

// A keyframe at `center` that looks along z, with one keypoint.
KeyFrame MakeKeyFrame(std::uint64_t id, double time, const Eigen::Vector3f& center, float x, float y) {
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(id);
  keyframe.timestamp = time;
  keyframe.camera = CameraId(0);
  keyframe.camera_from_world.translation = -center;
  keyframe.features.count = 1;
  keyframe.features.keypoints = keyframe.features.undistorted = {KeypointAt(x, y)};
  keyframe.features.right_x = keyframe.features.depth = {-1};
  keyframe.features.map_points = {MapPointId(0)};
  return keyframe;
}

MapPoint MakePoint(std::uint64_t id, const Eigen::Vector3f& position, Column<Observation> observations) {
  MapPoint point;
  point.id = MapPointId(id);
  point.position = position;
  point.observations = std::move(observations);
  return point;
}

// Three keyframes in a row, 3 m and 4 m apart, listed out of time order; the third is not connected.
Atlas HandMade() {
  Atlas atlas;
  Camera camera;
  camera.id = CameraId(0);
  camera.parameters = {100, 100, 50, 50};
  atlas.cameras = {camera};
  Map map;
  map.id = MapId(7);
  map.keyframes.push_back(MakeKeyFrame(20, 3.5, {3, 4, 0}, 0, 0));
  map.keyframes.push_back(MakeKeyFrame(10, 1, {0, 0, 0}, 53, 54));  // 5 pixels from (50, 50)
  map.keyframes.push_back(MakeKeyFrame(15, 2, {3, 0, 0}, 20, 50));  // exact: 100 * -3 / 10 + 50
  map.keyframes[1].connections = {{KeyFrameId(15), 1}};             // listed by one side only
  map.keyframes[1].loop_edges = {KeyFrameId(15)};
  map.keyframes[2].loop_edges = {KeyFrameId(10)};
  map.keyframes[0].merge_edges = {KeyFrameId(10)};
  map.keyframes[0].origin_map = 3;
  map.points.push_back(MakePoint(0, {0, 0, 10}, {{KeyFrameId(10), 0, -1}, {KeyFrameId(15), 0, -1}}));
  map.points.push_back(MakePoint(5, {-1, 2, 8}, {}));
  map.points.push_back(MakePoint(6, {100, 100, 100}, {}));
  map.points[2].bad = true;
  atlas.maps.push_back(std::move(map));
  return atlas;
}

TEST(ComputeStatistics, CountsAHandMadeAtlas) {
  const AtlasStatistics statistics = ComputeStatistics(HandMade(), 1);
  ASSERT_EQ(statistics.maps.size(), 1U);
  const MapStatistics& map = statistics.maps[0];
  EXPECT_EQ(map.id, MapId(7));
  EXPECT_EQ(map.sensor, MapSensor::kMonocular);
  EXPECT_FALSE(map.has_imu);
  EXPECT_EQ(map.keyframes, 3U);
  EXPECT_EQ(map.points, 3U);
  EXPECT_EQ(map.bad_points, 1U);
  EXPECT_EQ(map.bad_keyframes, 0U);
  EXPECT_EQ(map.features, 3U);
  EXPECT_EQ(map.observations, 2U);
  EXPECT_EQ(map.covisibility_edges, 1U);
  EXPECT_EQ(map.loop_edges, 1U);
  EXPECT_EQ(map.merge_edges, 1U);
  EXPECT_EQ(map.components, 2U);
  EXPECT_EQ(map.largest_component, 2U);
  EXPECT_DOUBLE_EQ(map.trajectory_length, 7);
  EXPECT_EQ(map.begin_time, 1);
  EXPECT_EQ(map.end_time, 3.5);
  EXPECT_EQ(map.bounding_box.min(), Eigen::Vector3f(-1, 0, 8));
  EXPECT_EQ(map.bounding_box.max(), Eigen::Vector3f(0, 2, 10));
  EXPECT_THAT(map.origins, ElementsAre(OriginCount{0, 2}, OriginCount{3, 1}));
  EXPECT_EQ(map.largest_keyframe_id, 20U);
  EXPECT_EQ(map.largest_point_id, 6U);
  EXPECT_EQ(statistics.cameras, 1U);
  EXPECT_EQ(statistics.observations, 2U);
  EXPECT_DOUBLE_EQ(statistics.trajectory_length, 7);
}

TEST(ComputeStatistics, DescribesObserversAndReprojection) {
  const MapStatistics map = ComputeStatistics(HandMade()).maps[0];
  EXPECT_EQ(map.observers.count, 2U);
  EXPECT_DOUBLE_EQ(map.observers.mean, 1);
  EXPECT_DOUBLE_EQ(map.observers.median, 2);
  EXPECT_DOUBLE_EQ(map.observers.max, 2);
  ASSERT_EQ(map.observer_histogram.size(), MapStatistics::kHistogramSize);
  EXPECT_EQ(map.observer_histogram[0], 1U);
  EXPECT_EQ(map.observer_histogram[2], 1U);
  EXPECT_EQ(map.reprojection_error.count, 2U);
  EXPECT_NEAR(map.reprojection_error.mean, 2.5, 1e-5);
  EXPECT_NEAR(map.reprojection_error.max, 5, 1e-5);
  EXPECT_EQ(map.unprojectable, 0U);
}

TEST(ComputeStatistics, TellsTheSensors) {
  struct Expected {
    Sensor sensor;
    bool inertial;
    MapSensor found;
  };
  for (const auto& [sensor, inertial, found] : {Expected{Sensor::kMonocular, false, MapSensor::kMonocular},
                                                Expected{Sensor::kMonocular, true, MapSensor::kMonocular},
                                                Expected{Sensor::kStereo, true, MapSensor::kStereoOrRgbd},
                                                Expected{Sensor::kRgbd, false, MapSensor::kStereoOrRgbd},
                                                Expected{Sensor::kFisheyeStereo, true, MapSensor::kFisheyeStereo}}) {
    SyntheticOptions options;
    options.sensor = sensor;
    options.inertial = inertial;
    const Atlas atlas = SynthesizeAtlas(options);
    const MapStatistics map = ComputeStatistics(atlas).maps[0];
    EXPECT_EQ(map.sensor, found);
    EXPECT_EQ(map.has_imu, inertial);
    EXPECT_EQ(map.metric, sensor != Sensor::kMonocular || inertial);
    EXPECT_EQ(IsMetric(atlas.maps[0]), map.metric);
    EXPECT_EQ(map.components, 1U);
    EXPECT_EQ(map.unprojectable, 0U);
    EXPECT_EQ(map.observations, Summarize(atlas).observations);
    if (found == MapSensor::kFisheyeStereo)
      EXPECT_GT(map.reprojection_error.count, map.observations) << "of each camera";
    else
      EXPECT_EQ(map.reprojection_error.count, map.observations);
    EXPECT_LT(map.reprojection_error.mean, 2);
  }
}

TEST(ComputeStatistics, DoesNotDependOnTheNumberOfThreads) {
  SyntheticOptions options;
  options.points = 5000;
  options.features = 1000;
  options.keyframes = 40;
  const Atlas atlas = SynthesizeAtlas(options);
  const MapStatistics one = ComputeStatistics(atlas, 1).maps[0], four = ComputeStatistics(atlas, 4).maps[0];
  EXPECT_EQ(one.reprojection_error.mean, four.reprojection_error.mean);
  EXPECT_EQ(one.reprojection_error.median, four.reprojection_error.median);
  EXPECT_EQ(one.observer_histogram, four.observer_histogram);
}

TEST(ComputeStatistics, TakesAnEmptyAtlasAndAnEmptyMap) {
  EXPECT_EQ(ComputeStatistics(Atlas()).maps.size(), 0U);
  Atlas atlas;
  atlas.maps.resize(1);
  const MapStatistics map = ComputeStatistics(atlas).maps[0];
  EXPECT_EQ(map.sensor, MapSensor::kUnknown);
  EXPECT_TRUE(map.bounding_box.isEmpty());
  EXPECT_EQ(map.components, 0U);
}

TEST(ComputeStatistics, LeavesOutWhatIsDamaged) {
  Atlas atlas = HandMade();
  Map& map = atlas.maps[0];
  map.points.push_back(MakePoint(8, {kNan, 0, 1}, {{KeyFrameId(10), 0, -1}}));  // no place
  map.points.push_back(MakePoint(9, {0, 0, 1},
                                 {{KeyFrameId(999), 0, -1},                   // no such keyframe
                                  {KeyFrameId(10), 1 << 30, -1},              // no such row
                                  {KeyFrameId(15), Observation::kAbsent, 5},  // no right camera
                                  {KeyFrameId(20), -1, -1}}));
  map.points.push_back(MakePoint(9, {0, 0, -5}, {{KeyFrameId(10), 0, -1}}));   // behind, and an id twice
  map.keyframes[0].connections = {{KeyFrameId(999), 5}, {KeyFrameId(20), 5}};  // dangling, and itself
  map.keyframes[0].loop_edges = {KeyFrameId(), KeyFrameId(998)};
  map.keyframes[0].features.count = -5;
  map.keyframes[0].features.left_count = 1 << 30;
  map.keyframes[0].camera_from_world.rotation.coeffs().setZero();
  map.keyframes[2].camera = CameraId(77);
  map.keyframes.push_back(MakeKeyFrame(30, kNan, {9, 9, 9}, 0, 0));
  map.keyframes.push_back(MakeKeyFrame(31, 2.5, {kNan, 9, 9}, 0, 0));
  atlas.cameras[0].parameters = {100, 100, 50, 50};
  const MapStatistics found = ComputeStatistics(atlas).maps[0];
  EXPECT_EQ(found.keyframes, 5U);
  EXPECT_EQ(found.features, 4U);
  EXPECT_EQ(found.covisibility_edges, 1U);
  EXPECT_EQ(found.loop_edges, 1U);
  EXPECT_TRUE(std::isfinite(found.trajectory_length));
  EXPECT_EQ(found.begin_time, 1);
  EXPECT_EQ(found.end_time, 3.5);
  EXPECT_EQ(found.bounding_box.min(), Eigen::Vector3f(-1, 0, -5));
  EXPECT_EQ(found.reprojection_error.count, 1U);
  EXPECT_EQ(found.unprojectable, 6U);
}

}  // namespace
}  // namespace slamdb
