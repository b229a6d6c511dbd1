// SPDX-License-Identifier: BSD-3-Clause
#include "tests/build/taken_apart.h"

#include <algorithm>

#include "slamdb/build/links.h"
#include "slamdb/checks/check.h"
#include "slamdb/model/index.h"
#include "slamdb/pictures/camera_settings.h"
#include "tests/support/postload.h"

namespace slamdb {
namespace {

// What a front end finds in a picture.
Features FoundIn(const KeyFrame& keyframe) {
  const Features& all = keyframe.features;
  Features found;
  found.keypoints = all.keypoints;
  found.descriptors = all.descriptors;
  found.right_x = all.right_x;
  found.depth = all.depth;
  if (!all.is_fisheye_stereo()) return found;
  found.right_keypoints = all.right_keypoints;
  found.right_of_left = all.right_of_left;
  found.left_of_right = all.left_of_right;
  return found;
}

NewImu ImuOf(const Map& map) {
  const ImuCalibration& calibration = map.keyframes.front().imu_calibration;
  NewImu imu{.body_from_camera = calibration.body_from_camera,
             .noise = calibration.noise,
             .walk_noise = calibration.walk_noise};
  for (const KeyFrame& keyframe : map.keyframes) {
    imu.measurements.push_back(keyframe.preintegration.measurements);
    imu.velocities.push_back(keyframe.velocity);
    imu.biases.push_back(keyframe.imu_bias);
    imu.integration_biases.push_back(keyframe.preintegration.bias);
    imu.previous.push_back(keyframe.previous);
  }
  return imu;
}

ImuStage StageOf(const Map& map) {
  if (map.imu_ba2) return ImuStage::kAdjustedTwice;
  if (map.imu_ba1) return ImuStage::kAdjusted;
  return map.imu_initialized ? ImuStage::kInitialized : ImuStage::kNone;
}

}  // namespace

NewKeyFrames KeyFramesOf(const Map& map) {
  const KeyFrame& first = map.keyframes.front();
  NewKeyFrames columns;
  for (const KeyFrame& keyframe : map.keyframes) {
    columns.timestamps.push_back(keyframe.timestamp);
    columns.camera_from_world.push_back(keyframe.camera_from_world);
    columns.features.push_back(FoundIn(keyframe));
    columns.ids.push_back(keyframe.id);
  }
  columns.camera = first.camera;
  columns.right_camera = first.right_camera;
  columns.left_from_right = first.left_from_right;
  columns.distortion = DistortionOf(first);
  columns.width = columns.distortion.empty() ? first.bounds.max_x - first.bounds.min_x : 640;
  columns.height = columns.distortion.empty() ? first.bounds.max_y - first.bounds.min_y : 480;
  columns.baseline = first.right_camera ? 0 : static_cast<double>(first.intrinsics.baseline);
  columns.depth_threshold = static_cast<double>(first.intrinsics.depth_threshold);
  columns.levels = first.pyramid.levels;
  columns.scale_factor = first.pyramid.factor;
  if (map.inertial) columns.imu = ImuOf(map);
  return columns;
}

NewPoints PointsOf(const Map& map) {
  const IdTable keyframes = KeyFrameTable(map);
  NewPoints columns;
  for (const MapPoint& point : map.points) {
    const std::size_t before = columns.observations.size();
    for (const Observation& seen : point.observations) {
      const std::uint32_t row = keyframes.Find(seen.keyframe.value());
      for (const std::int32_t keypoint : {seen.left, seen.right})
        if (keypoint >= 0 && row != kNoRow &&
            map.keyframes[row].features.map_points[static_cast<std::size_t>(keypoint)] == point.id)
          columns.observations.push_back({columns.ids.size(), seen.keyframe, static_cast<std::uint64_t>(keypoint)});
    }
    if (columns.observations.size() == before) continue;
    columns.ids.push_back(point.id);
    columns.positions.push_back(point.position);
  }
  return columns;
}

Atlas BuiltAnew(const Atlas& atlas) {
  Atlas built;
  built.vocabulary = atlas.vocabulary;
  for (const Camera& camera : atlas.cameras) AddCamera(built, camera.model, camera.parameters, camera.id);
  for (const Map& map : atlas.maps) {
    AddMap(built, map.id);
    if (map.keyframes.empty()) continue;
    AddKeyFrames(built, map.id, KeyFramesOf(map));
    AddPoints(built, map.id, PointsOf(map));
    if (map.inertial) SetImuStage(*std::ranges::find(built.maps, map.id, &Map::id), StageOf(map));
  }
  return built;
}

std::string TroublesOf(const Atlas& atlas, std::vector<std::string> ignored) {
  std::string troubles;
  for (const RuleResult& result : CheckAtlas(atlas, {.ignore = std::move(ignored)}).results)
    if (result.severity == Severity::kError || result.severity == Severity::kWarning)
      troubles += result.id + ": " + (result.findings.empty() ? "" : result.findings.front().message) + "\n";
  for (const std::string& trouble : LoadTroubles(atlas, ~std::uint64_t{0})) troubles += trouble + "\n";
  return troubles;
}

}  // namespace slamdb
