// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/map_extent.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/path.h"
#include "slamdb/model/sensor.h"

namespace slamdb {
namespace detail {
namespace {

// Where features were left out when reading, the baseline tells.
bool HasDepths(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  if (features.right_x.empty()) return keyframe.intrinsics.baseline_fx > 0;
  return std::ranges::any_of(features.right_x, [](float right_x) { return right_x >= 0; });
}

// Of more than half of the keyframes.
template <class Has>
bool OfMost(const Map& map, const Has& has) {
  return static_cast<std::size_t>(std::ranges::count_if(map.keyframes, has)) > map.keyframes.size() / 2;
}

}  // namespace

bool MeasuresDepth(const KeyFrame& keyframe) { return keyframe.features.is_fisheye_stereo() || HasDepths(keyframe); }

Trajectory TrajectoryOf(const Map& map) {
  const std::vector<const KeyFrame*> by_time = GoodByTime(map);
  if (by_time.empty()) return {};
  Trajectory trajectory{
      .empty = false, .begin_time = by_time.front()->timestamp, .end_time = by_time.back()->timestamp};
  std::optional<Eigen::Vector3d> previous;
  for (const KeyFrame* keyframe : by_time) {
    const Eigen::Vector3f center = CameraCenter(*keyframe);
    if (!center.allFinite()) continue;
    if (previous) trajectory.length += (center.cast<double>() - *previous).norm();
    previous = center.cast<double>();
  }
  return trajectory;
}

}  // namespace detail

MapSensor SensorOf(const Map& map) {
  if (map.keyframes.empty()) return MapSensor::kUnknown;
  if (detail::OfMost(map, [](const KeyFrame& keyframe) { return keyframe.features.is_fisheye_stereo(); }))
    return MapSensor::kFisheyeStereo;
  return detail::OfMost(map, detail::HasDepths) ? MapSensor::kStereoOrRgbd : MapSensor::kMonocular;
}

bool HasImu(const Map& map) {
  return map.inertial ||
         detail::OfMost(map, [](const KeyFrame& keyframe) -> bool { return keyframe.imu_calibration.is_set; });
}

bool IsMetric(const Map& map) {
  return map.imu_initialized || map.keyframes.empty() || std::ranges::any_of(map.keyframes, detail::MeasuresDepth);
}

}  // namespace slamdb
