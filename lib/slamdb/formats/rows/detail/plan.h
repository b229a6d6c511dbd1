// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamdb::rows {

// A keyframe or point as the store has it: its row and what is needed to see whether it changed.
struct StoredRow {
  std::int64_t row = 0;
  std::int64_t id = 0;
  bool unique = true;        // the first of its id in the list
  std::int64_t hash = 0;     // of the row itself
  std::int64_t details = 0;  // of what hangs on it: a point's observations, a keyframe's links
};

// What saving a list does to its rows.
struct ListPlan {
  struct Entry {
    std::int64_t row = 0;
    bool unique = true;
    const StoredRow* stored = nullptr;  // null: a new row
  };
  std::vector<Entry> entries;         // one for each entity of the list, in its order
  std::vector<std::int64_t> removed;  // rows to delete, ascending
};

// Matches the entities of a list, by id and by how often that id came before, with the rows in the store (ascending),
// so that entities keep their rows; new ones come behind them. `first_row` is the list's first possible row. Throws
// Error when there are no more rows.
ListPlan PlanList(std::span<const std::int64_t> ids, std::span<const StoredRow> stored, std::int64_t first_row);

// Rows of a map's lists: map * 2^32 + place.
constexpr std::int64_t FirstRowOfMap(std::int64_t map) { return map << 32; }
constexpr std::int64_t LastRowOfMap(std::int64_t map) { return (map << 32) + 0xffffffff; }
constexpr std::int64_t MapOfRow(std::int64_t row) { return row >> 32; }

}  // namespace slamdb::rows
