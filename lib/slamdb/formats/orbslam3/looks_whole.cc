// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/looks_whole.h"

#include <algorithm>
#include <cmath>

#include "slamdb/model/detail/is_pose.h"

namespace slamdb::orbslam3 {
namespace {

bool Holds(const Flag& flag) { return flag.recorded <= 1; }

}  // namespace

bool LooksWhole(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  const auto count = static_cast<std::size_t>(std::max(features.count, 0));
  const std::size_t left = features.is_fisheye_stereo() ? static_cast<std::size_t>(features.left_count) : count;
  const auto levels = static_cast<std::size_t>(std::max(keyframe.pyramid.levels, 0));
  const auto columns = static_cast<std::size_t>(std::max(keyframe.bounds.grid_columns, 0));
  return features.keypoints.size() == left && features.undistorted.size() == left &&
         keyframe.descriptor_count() == count && features.map_points.size() == count &&
         keyframe.pyramid.factors.size() == levels && features.grid.column_sizes.size() == columns &&
         slamdb::detail::IsUnit(keyframe.camera_from_world.rotation) && Holds(keyframe.first_connection) &&
         Holds(keyframe.not_erase) && Holds(keyframe.to_be_erased) && Holds(keyframe.bad) &&
         Holds(keyframe.imu_initialized) && Holds(keyframe.has_velocity) && Holds(keyframe.imu_calibration.is_set);
}

bool LooksWhole(const MapPoint& point) {
  const auto paired = [](const Observation& observation) {
    return observation.left != Observation::kAbsent && observation.right != Observation::kAbsent;
  };
  return (point.has_descriptor() || point.has_other_descriptor()) && Holds(point.bad) && point.position.allFinite() &&
         point.normal.allFinite() && point.min_distance <= point.max_distance && std::isfinite(point.max_distance) &&
         std::ranges::all_of(point.observations, paired) &&
         std::ranges::is_sorted(point.observations, {}, &Observation::keyframe);
}

bool LooksWhole(const Camera& camera) {
  const std::size_t parameters = camera.model == CameraModel::kPinhole ? 4 : 8;
  const std::uint32_t type = camera.model == CameraModel::kPinhole ? 0 : 1;
  const auto fits = [](float value) { return std::abs(value) < 1e6F; };  // no NaN either
  return camera.recorded_type == type && camera.parameters.size() == parameters &&
         std::ranges::all_of(camera.parameters, fits) && camera.parameters[0] > 1e-3F && camera.parameters[1] > 1e-3F;
}

bool LooksWhole(const Map& tail, std::uint64_t largest_keyframe) {
  const auto fits = [&](KeyFrameId id) { return id.value() <= largest_keyframe; };
  return std::ranges::all_of(tail.origins, fits) && fits(tail.first_keyframe) && fits(tail.lowest_keyframe) &&
         Holds(tail.imu_initialized) && Holds(tail.inertial) && Holds(tail.imu_ba1) && Holds(tail.imu_ba2);
}

}  // namespace slamdb::orbslam3
