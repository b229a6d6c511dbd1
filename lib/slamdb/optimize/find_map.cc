// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/find_map.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

std::size_t FindMap(const Atlas& atlas, MapId id) {
  const auto found = std::ranges::find(atlas.maps, id, &Map::id);
  if (found == atlas.maps.end()) throw Error(ErrorKind::kNotFound, "there is no " + ToString(id));
  return static_cast<std::size_t>(found - atlas.maps.begin());
}

std::vector<std::uint32_t> RowsOf(const Map& map, std::span<const KeyFrameId> ids) {
  const IdTable table = KeyFrameTable(map);
  std::vector<std::uint32_t> rows;
  for (const KeyFrameId id : ids) {
    const std::uint32_t row = table.Find(id.value());
    if (row == kNoRow) throw Error(ErrorKind::kNotFound, ToString(map.id) + " has no " + ToString(id));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace slamdb::detail
