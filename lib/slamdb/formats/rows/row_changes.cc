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

TableChanges TotalOf(const ChangeCounter& changes) { return SaveReport{.tables = changes.Take()}.Total(); }

}  // namespace slamdb::rows

namespace slamdb {

TableChanges SaveReport::Total() const {
  TableChanges total{.table = "total"};
  for (const TableChanges& changes : tables) {
    total.inserted += changes.inserted;
    total.updated += changes.updated;
    total.deleted += changes.deleted;
    total.unchanged += changes.unchanged;
  }
  return total;
}

}  // namespace slamdb
