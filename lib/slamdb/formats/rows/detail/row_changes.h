// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "slamdb/formats/rows/detail/change_counter.h"
#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/formats/rows/detail/match_maps.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/model/atlas.h"

// What a save makes of the rows that a store has, whichever database keeps them.
namespace slamdb::rows {

// The plan of a map's list; `map` is the row of the map.
template <class Entities>
ListPlan PlanOf(const Entities& entities, const std::vector<StoredRow>& stored, std::int64_t map) {
  std::vector<std::int64_t> ids;
  ids.reserve(entities.size());
  for (const auto& entity : entities) ids.push_back(ToColumn(entity.id));
  return PlanList(ids, stored, FirstRowOfMap(map));
}

// Whether the row of an entity is there as it is; and what hangs on it, besides.
inline bool HasRow(const ListPlan::Entry& entry, std::int64_t hash) {
  return entry.stored != nullptr && entry.stored->hash == hash && entry.stored->unique == entry.unique;
}
inline bool HasDetails(const ListPlan::Entry& entry, std::int64_t details) {
  return entry.stored != nullptr && entry.stored->details == details;
}
// The same of a map, the `position`th, without its lists. Row 0: the store has no such map.
inline bool HasMap(const StoredMap& stored, std::int64_t hash, std::size_t position) {
  return stored.row != 0 && stored.hash == hash && stored.position == static_cast<std::int64_t>(position);
}

// Counts a row that is there as it is, or is written.
inline void Count(TableChanges& changes, bool is_same, bool is_new) {
  ++(is_same ? changes.unchanged : is_new ? changes.inserted : changes.updated);
}
// Counts all of an atlas that is there as it is.
void CountUnchanged(const Atlas& atlas, ChangeCounter& changes);
// Of all tables.
TableChanges TotalOf(const ChangeCounter& changes);

}  // namespace slamdb::rows
