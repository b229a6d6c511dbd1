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

}  // namespace slamdb::detail
