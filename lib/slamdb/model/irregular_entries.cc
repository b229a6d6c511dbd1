// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/irregular_entries.h"

namespace slamdb::detail {

std::uint64_t DropIrregularEntries(Atlas& atlas) {
  std::uint64_t dropped = 0;
  const auto drop = [&](std::vector<RepeatedEntry>& entries) {
    dropped += entries.size();
    entries.clear();
  };
  drop(atlas.repeated_maps);
  drop(atlas.repeated_cameras);
  for (Map& map : atlas.maps) {
    drop(map.repeated_keyframes);
    drop(map.repeated_points);
  }
  return dropped;
}

}  // namespace slamdb::detail
