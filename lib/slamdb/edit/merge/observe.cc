// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/observe.h"

#include <algorithm>
#include <vector>

#include "slamdb/edit/merge/detail/refresh_points.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

bool IsRightKeypoint(const KeyFrame& keyframe, std::uint32_t keypoint) {
  return keyframe.right_camera && static_cast<std::int64_t>(keypoint) >= keyframe.features.left_count;
}

// Whether it was not seen before, and the keypoint was free.
bool Observe(const SeenPoint& seen, KeyFrame& keyframe, MapPoint& point) {
  if (seen.keypoint >= keyframe.features.map_points.size()) return false;
  MapPointId& slot = keyframe.features.map_points[seen.keypoint];
  const auto place = std::ranges::lower_bound(point.observations, keyframe.id, {}, &Observation::keyframe);
  if (slot || (place != point.observations.end() && place->keyframe == keyframe.id)) return false;
  Observation observation{.keyframe = keyframe.id};
  (IsRightKeypoint(keyframe, seen.keypoint) ? observation.right : observation.left) =
      static_cast<std::int32_t>(seen.keypoint);
  slot = point.id;
  point.observations.insert(place, observation);
  point.observation_count += ObservationWeight(keyframe, observation);
  return true;
}

}  // namespace

std::uint64_t AddObservations(Map& map, std::span<const SeenPoint> seen) {
  const IdTable keyframes = KeyFrameTable(map), points = PointTable(map);
  std::vector<MapPointId> changed;
  for (const SeenPoint& each : seen) {
    const std::uint32_t keyframe = keyframes.Find(each.keyframe.value()), point = points.Find(each.point.value());
    if (keyframe == kNoRow || point == kNoRow) continue;
    if (Observe(each, map.keyframes[keyframe], map.points[point])) changed.push_back(each.point);
  }
  if (changed.empty()) return 0;
  const std::uint64_t added = changed.size();
  detail::RefreshPoints(map, std::move(changed));
  return added;
}

}  // namespace slamdb
