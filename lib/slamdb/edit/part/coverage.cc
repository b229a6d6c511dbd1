// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/coverage.h"

#include <algorithm>

namespace slamdb {
namespace {

// Good keyframes of a map with at least `min_points` points that `has` accepts.
template <class Has>
std::uint64_t CountCovered(const AtlasIndex& index, std::size_t map_row, std::size_t min_points, const Has& has) {
  const Map& map = index.atlas().maps[map_row];
  std::vector<std::size_t> seen(map.keyframes.size(), 0);
  for (std::size_t row = 0; row < map.points.size(); ++row) {
    if (map.points[row].bad || !has(row)) continue;
    for (const Observation& observation : map.points[row].observations)
      if (const std::uint32_t observer = index.KeyFrameRow(map_row, observation.keyframe); observer != kNoRow)
        ++seen[observer];
  }
  std::uint64_t covered = 0;
  for (std::size_t row = 0; row < seen.size(); ++row)
    if (!map.keyframes[row].bad && seen[row] >= min_points) ++covered;
  return covered;
}

}  // namespace

Coverage MeasureCoverage(const AtlasIndex& index, const Subset& kept, std::size_t min_points) {
  Coverage coverage{.min_points = min_points};
  for (std::size_t map_row = 0; map_row < index.atlas().maps.size(); ++map_row) {
    const Map& map = index.atlas().maps[map_row];
    const Subset::MapRows& rows = kept.maps.at(map_row);
    coverage.places += static_cast<std::uint64_t>(
        std::ranges::count_if(map.keyframes, [](const KeyFrame& keyframe) { return !keyframe.bad; }));
    coverage.covered_before += CountCovered(index, map_row, min_points, [](std::size_t) { return true; });
    coverage.covered += CountCovered(index, map_row, min_points, [&](std::size_t row) {
      return rows.points[row] && std::ranges::any_of(map.points[row].observations, [&](const Observation& observation) {
               const std::uint32_t observer = index.KeyFrameRow(map_row, observation.keyframe);
               return observer != kNoRow && rows.keyframes[observer];
             });
    });
  }
  return coverage;
}

}  // namespace slamdb
