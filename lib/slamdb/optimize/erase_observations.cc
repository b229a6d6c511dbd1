// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/erase_observations.h"

#include <algorithm>

#include "slamdb/edit/part/subset.h"
#include "slamdb/model/derive.h"

namespace slamdb::detail {
namespace {

void EmptySlot(const Measurement& measurement, MapPointId point, KeyFrame& keyframe) {
  Column<MapPointId>& slots = keyframe.features.map_points;
  const auto row = static_cast<std::size_t>(measurement.keypoint);
  if (row < slots.size() && slots[row] == point) slots[row] = {};
}

// Counts what is left, and sees to the reference keyframe. Whether the point stays.
bool Settle(const Map& map, const IdTable& rows, MapPoint& point) {
  std::erase_if(point.observations, [](const Observation& seen) { return seen.left < 0 && seen.right < 0; });
  point.observation_count = 0;
  for (const Observation& observation : point.observations)
    if (const std::uint32_t row = rows.Find(observation.keyframe.value()); row != kNoRow)
      point.observation_count += ObservationWeight(map.keyframes[row], observation);
  if (point.observation_count <= kCulledAt) return false;
  if (std::ranges::find(point.observations, point.reference, &Observation::keyframe) == point.observations.end())
    point.reference = std::ranges::min(point.observations, {}, &Observation::keyframe).keyframe;
  return true;
}

}  // namespace

std::vector<std::uint8_t> EraseObservations(std::span<const Measurement* const> measurements, Map& map) {
  const IdTable rows = KeyFrameTable(map);
  std::vector<std::uint8_t> culled(map.points.size(), 0);
  for (const Measurement* measurement : measurements) {
    MapPoint& point = map.points[measurement->point];
    Observation& observation = point.observations[measurement->observation];
    (measurement->right ? observation.right : observation.left) = -1;
    EmptySlot(*measurement, point.id, map.keyframes[measurement->keyframe]);
    culled[measurement->point] = 1;
  }
  for (std::size_t row = 0; row < culled.size(); ++row)
    if (culled[row]) culled[row] = !Settle(map, rows, map.points[row]);
  return culled;
}

}  // namespace slamdb::detail
