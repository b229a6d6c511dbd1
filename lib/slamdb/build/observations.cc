// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "slamdb/build/detail/columns.h"
#include "slamdb/build/detail/observing.h"
#include "slamdb/build/links.h"

namespace slamdb {
namespace {

// Of points by row: their observations as they will be.
using Lists = std::map<std::uint32_t, Column<Observation>>;

Lists ListsWith(std::span<const PointObservation> added, const Map& map, detail::Observing& observing) {
  const IdTable points = PointTable(map);
  Lists lists;
  for (std::size_t row = 0; row < added.size(); ++row) {
    const auto& [id, keyframe, keypoint] = added[row];
    const std::uint32_t point = points.Find(id.value());
    if (point == kNoRow)
      detail::RefuseRow("points", row, "is ", id.value(),
                        ", which the map does not have; AddPoints (add_points) adds it");
    if (map.points[point].bad)
      detail::RefuseRow("points", row, "is ", id.value(), ", which is culled; `repair` removes it");
    const auto [list, is_new] = lists.try_emplace(point);
    if (is_new) list->second = map.points[point].observations;
    observing.Add(id.value(), keyframe, keypoint, row, list->second);
  }
  for (auto& [point, list] : lists) std::ranges::stable_sort(list, {}, &Observation::keyframe);
  return lists;
}

}  // namespace

void AddObservations(Map& map, std::span<const PointObservation> added) {
  detail::Observing observing(map, {.point = "points", .keyframe = "keyframes", .keypoint = "keypoints"});
  Lists lists = ListsWith(added, map, observing);
  for (const PointObservation& seen : added)
    map.keyframes[observing.RowOf(seen.keyframe)].features.map_points[seen.keypoint] = seen.point;
  std::vector<std::uint32_t> points;
  std::set<std::uint32_t> observers;
  for (auto& [point, list] : lists) {
    for (const Observation& observation : list)
      if (const std::uint32_t row = observing.RowOf(observation.keyframe); row != kNoRow) observers.insert(row);
    map.points[point].observations = std::move(list);
    points.push_back(point);
  }
  UpdatePoints(map, points);
  detail::UpdateGraph(map, {observers.begin(), observers.end()});
}

}  // namespace slamdb
