// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/row_changes.h"

namespace slamdb::rows {

void CountUnchanged(const Atlas& atlas, ChangeCounter& changes) {
  ++changes["atlas"].unchanged;
  changes["map"].unchanged += atlas.maps.size();
  changes["camera"].unchanged += atlas.cameras.size();
  for (const Map& map : atlas.maps) {
    for (const char* table : {"keyframe", "keyframe_features"}) changes[table].unchanged += map.keyframes.size();
    changes["map_point"].unchanged += map.points.size();
    if (!map.landmarks.empty()) changes["landmark"].unchanged += map.landmarks.size();
  }
}

TableChanges TotalOf(const ChangeCounter& changes) {
  TableChanges total;
  for (const TableChanges& each : changes.Take()) {
    total.inserted += each.inserted;
    total.updated += each.updated;
    total.deleted += each.deleted;
    total.unchanged += each.unchanged;
  }
  return total;
}

}  // namespace slamdb::rows
