// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/refresh_points.h"

#include <algorithm>

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

template <class Value>
void SortOnce(std::vector<Value>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

std::uint64_t RefreshPoints(Map& map, std::vector<MapPointId> points) {
  SortOnce(points);
  const IdTable keyframes = KeyFrameTable(map), rows = PointTable(map);
  const auto find = [&](KeyFrameId id) {
    const std::uint32_t row = keyframes.Find(id.value());
    return row == kNoRow ? nullptr : &map.keyframes[row];
  };
  std::vector<std::uint32_t> observers;
  for (const MapPointId id : points) {
    const std::uint32_t row = rows.Find(id.value());
    if (row == kNoRow) continue;
    MapPoint& point = map.points[row];
    for (const Observation& observation : point.observations)
      if (const std::uint32_t observer = keyframes.Find(observation.keyframe.value()); observer != kNoRow)
        observers.push_back(observer);
    const std::vector<Descriptor> descriptors = ObservedDescriptors(point, find);
    if (!descriptors.empty()) point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];
    point.normal = ObservedNormal(point, find).value_or(point.normal);
  }
  SortOnce(observers);
  UpdateCovisibility(map, observers);
  return observers.size();
}

}  // namespace slamdb::detail
