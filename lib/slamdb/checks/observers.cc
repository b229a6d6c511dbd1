// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/detail/observers.h"

#include <numeric>

#include "slamdb/model/derive.h"

namespace slamdb::detail {

Observers::Observers(const AtlasIndex& index, std::size_t map_row) {
  ListObservers(index, map_row);
  ListSights(index, map_row);
}

void Observers::ListObservers(const AtlasIndex& index, std::size_t map_row) {
  const Map& map = index.atlas().maps[map_row];
  std::size_t most = 0;
  for (const MapPoint& point : map.points) most += point.observations.size();
  observers_.reserve(most);
  point_begins_.reserve(map.points.size() + 1);
  keyframe_begins_.assign(map.keyframes.size() + 1, 0);
  ids_.reserve(map.points.size());
  for (const MapPoint& point : map.points) {
    ids_.push_back(point.id);
    point_begins_.push_back(observers_.size());
    if (point.bad) continue;
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = index.KeyFrameRow(map_row, observation.keyframe);
      if (row == kNoRow) continue;
      observers_.push_back(row);
      ++keyframe_begins_[row + 1];
    }
  }
  point_begins_.push_back(observers_.size());
  std::partial_sum(keyframe_begins_.begin(), keyframe_begins_.end(), keyframe_begins_.begin());
}

void Observers::ListSights(const AtlasIndex& index, std::size_t map_row) {
  const Map& map = index.atlas().maps[map_row];
  sights_.resize(observers_.size());
  counts_.assign(map.points.size(), 0);
  std::vector<std::uint64_t> next = keyframe_begins_;
  for (std::uint32_t point = 0; point < map.points.size(); ++point) {
    if (map.points[point].bad) continue;
    for (const Observation& observation : map.points[point].observations) {
      const std::uint32_t row = index.KeyFrameRow(map_row, observation.keyframe);
      if (row == kNoRow) continue;
      sights_[next[row]++] = {point, observation.left, observation.right};
    }
  }
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row)
    for (const Sight& sight : By(row))
      counts_[sight.point] += ObservationWeight(map.keyframes[row], {{}, sight.left, sight.right});
}

}  // namespace slamdb::detail
