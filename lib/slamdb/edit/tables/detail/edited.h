// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {

// What tables said of the rows of a list: one flag for each.
struct EditedRows {
  std::vector<std::uint8_t> seen, moved, own_normal, own_range, dropped;
  explicit EditedRows(std::size_t size) : seen(size), moved(size), own_normal(size), own_range(size), dropped(size) {}
};
struct EditedMap {
  EditedRows points, keyframes;
  explicit EditedMap(const Map& map) : points(map.points.size()), keyframes(map.keyframes.size()) {}
};

// Normals and distance ranges of points that moved or that moved keyframes see, as their observers see them, but for
// those that a table gave. `index` is of the atlas. Returns how many points that was.
// Cost: linear.
std::uint64_t RefreshMoved(const AtlasIndex& index, const std::vector<EditedMap>& edited, Atlas& atlas);

}  // namespace slamdb::detail
