// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {

// The row of the kept keyframe before that at `row` in time, and the rows of those between that are not kept, newest
// first; kNoRow when there is none. Only along links that agree both ways, so that every keyframe is passed once.
// `row_of` gives the row of an id, or kNoRow.
template <class RowOf>
std::uint32_t KeptBefore(const Map& map, const std::vector<std::uint8_t>& kept, std::uint32_t row, const RowOf& row_of,
                         std::vector<std::uint32_t>& between) {
  between.clear();
  std::uint32_t later = row, earlier = row_of(map.keyframes[row].previous);
  while (earlier != kNoRow && map.keyframes[earlier].next == map.keyframes[later].id &&
         between.size() < map.keyframes.size()) {  // a chain of keyframes with one id may lead in a circle
    if (kept[earlier]) return earlier;
    between.push_back(earlier);
    later = std::exchange(earlier, row_of(map.keyframes[earlier].previous));
  }
  return kNoRow;
}

}  // namespace slamdb::detail
