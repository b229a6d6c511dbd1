// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/model/derive.h"

// What the observations of a point say it is, as ORB-SLAM3 derives it. `find` gives the keyframe of an id, or null;
// observations by keyframes that are not there say nothing.
namespace slamdb::detail {

// The descriptors of the keypoints that the point is.
template <class Find>
std::vector<Descriptor> ObservedDescriptors(const MapPoint& point, const Find& find) {
  std::vector<Descriptor> descriptors;
  for (const Observation& observation : point.observations) {
    const KeyFrame* keyframe = find(observation.keyframe);
    if (keyframe == nullptr) continue;
    const Column<Descriptor>& column = keyframe->features.descriptors;
    for (const std::int32_t row : {observation.left, observation.right})
      if (row >= 0 && static_cast<std::size_t>(row) < column.size())
        descriptors.push_back(column[static_cast<std::size_t>(row)]);
  }
  return descriptors;
}

// The mean of the directions that the point is seen from (MapPoint::UpdateNormalAndDepth); nullopt without observers.
template <class Find>
std::optional<Eigen::Vector3f> ObservedNormal(const MapPoint& point, const Find& find) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  const auto add = [&](const Eigen::Vector3f& center) {
    sum += (point.position - center).normalized();
    ++count;
  };
  for (const Observation& observation : point.observations) {
    const KeyFrame* keyframe = find(observation.keyframe);
    if (keyframe == nullptr) continue;
    if (observation.left >= 0) add(CameraCenter(*keyframe));
    if (observation.right >= 0) add(RightCameraCenter(*keyframe));
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<float>(count);
}

// The distance range that the reference keyframe's observation gives; 0 to 0 when it has none.
inline DistanceRange ObservedRange(const MapPoint& point, const KeyFrame& reference) {
  const auto seen = std::ranges::find(point.observations, reference.id, &Observation::keyframe);
  if (seen == point.observations.end()) return {};
  const Keypoint* keypoint = ObservedKeypoint(reference, seen->left >= 0 ? seen->left : seen->right);
  if (keypoint == nullptr) return {};
  const float distance = (point.position - CameraCenter(reference)).norm();
  return DeriveDistanceRange(distance, keypoint->octave, reference.pyramid);
}

// Normal and distance range of a point as its observers see it (MapPoint::UpdateNormalAndDepth), but for what is its
// own. Whether any was set.
template <class Find>
bool RefreshView(const Find& find, bool own_normal, bool own_range, MapPoint& point) {
  bool refreshed = false;
  if (const auto normal = ObservedNormal(point, find); normal && !own_normal) {
    point.normal = *normal;
    refreshed = true;
  }
  const KeyFrame* reference = find(point.reference);
  if (reference == nullptr || own_range) return refreshed;
  const DistanceRange range = ObservedRange(point, *reference);
  if (!(range.max > 0)) return refreshed;
  point.min_distance = range.min;
  point.max_distance = range.max;
  return true;
}

}  // namespace slamdb::detail
