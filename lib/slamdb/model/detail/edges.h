// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {

// Edges between keyframes by their rows, the smaller first, each pair once, ascending: whichever of the two lists the
// other, which in a damaged file only one of them may.
using RowPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Sorts them, and drops what comes twice and what leads from a keyframe to itself.
inline void MakeDistinct(RowPairs& edges) {
  std::erase_if(edges, [](const auto& edge) { return edge.first == edge.second; });
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

// The loop or merge edges of a map. `row_of` gives the row of an id, or kNoRow.
template <class RowOf>
RowPairs EdgesOf(const Map& map, Column<KeyFrameId> KeyFrame::*list, const RowOf& row_of) {
  RowPairs edges;
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row)
    for (const KeyFrameId id : map.keyframes[row].*list)
      if (const std::uint32_t other = row_of(id); other != kNoRow) edges.push_back(std::minmax(row, other));
  MakeDistinct(edges);
  return edges;
}

// What ties keyframes to each other in ORB-SLAM3's essential graph. With an IMU also what came before.
enum class Tie { kTree, kLoop, kMerge, kInertial, kCovisibility };

// Calls visit(row, other's id, tie), kind after kind; both ends may say the same edge.
template <class Visit>
void ForEachTie(const Map& map, int min_weight, const Visit& visit) {
  const auto each = [&](const auto& of) {
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) of(row, map.keyframes[row]);
  };
  each([&](std::uint32_t row, const KeyFrame& keyframe) { visit(row, keyframe.parent, Tie::kTree); });
  each([&](std::uint32_t row, const KeyFrame& keyframe) {
    for (const KeyFrameId other : keyframe.loop_edges) visit(row, other, Tie::kLoop);
    for (const KeyFrameId other : keyframe.merge_edges) visit(row, other, Tie::kMerge);
  });
  if (map.inertial || map.imu_initialized)
    each([&](std::uint32_t row, const KeyFrame& keyframe) { visit(row, keyframe.previous, Tie::kInertial); });
  each([&](std::uint32_t row, const KeyFrame& keyframe) {
    for (const Connection& connection : keyframe.connections)
      if (connection.weight >= min_weight) visit(row, connection.keyframe, Tie::kCovisibility);
  });
}

}  // namespace slamdb::detail
