// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/plan.h"

#include <algorithm>
#include <unordered_map>

#include "slamdb/base/error.h"

namespace slamdb::sqlite {
namespace {

// An id, and how many entries of that id come before.
struct Key {
  std::int64_t id;
  std::uint32_t occurrence;
  friend bool operator==(const Key&, const Key&) = default;
};
struct KeyHash {
  std::size_t operator()(const Key& key) const {
    return static_cast<std::uint64_t>(key.id) * 0x9E3779B97F4A7C15u + key.occurrence;
  }
};

// Whether an entry may hold unique_id: the first of an id that is not `none`.
bool IsUnique(const Key& key) { return key.occurrence == 0 && key.id != -1; }

// Gives each entry of a list its Key.
class Occurrences {
 public:
  explicit Occurrences(std::size_t size) { seen_.reserve(size); }
  Key Next(std::int64_t id) { return {id, seen_[id]++}; }

 private:
  std::unordered_map<std::int64_t, std::uint32_t> seen_;
};

// The list with rows 0, 1, 2, ... as when it is saved for the first time.
ListPlan PlanAnew(std::span<const std::int64_t> ids, std::span<const StoredRow> stored, std::int64_t first_row) {
  ListPlan plan;
  plan.entries.reserve(ids.size());
  Occurrences occurrences(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    plan.entries.push_back({first_row + static_cast<std::int64_t>(i), IsUnique(occurrences.Next(ids[i])), nullptr});
  }
  for (const StoredRow& row : stored) plan.removed.push_back(row.row);
  return plan;
}

}  // namespace

ListPlan PlanList(std::span<const std::int64_t> ids, std::span<const StoredRow> stored, std::int64_t first_row) {
  if (ids.size() > 0xffffffffU) throw Error("a map with more than 4294967295 keyframes or points does not fit a store");
  if (stored.empty()) return PlanAnew(ids, stored, first_row);

  std::unordered_map<Key, std::size_t, KeyHash> by_key(stored.size());
  Occurrences stored_occurrences(stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) by_key.emplace(stored_occurrences.Next(stored[i].id), i);

  ListPlan plan;
  plan.entries.reserve(ids.size());
  std::vector<bool> used(stored.size());
  Occurrences occurrences(ids.size());
  std::int64_t next_row = first_row;  // the smallest row that keeps the order
  const std::int64_t end_row = stored.back().row + 1;
  for (const std::int64_t id : ids) {
    const Key key = occurrences.Next(id);
    const auto found = by_key.find(key);
    ListPlan::Entry entry{.row = 0, .unique = IsUnique(key), .stored = nullptr};
    if (found != by_key.end()) {
      entry.stored = &stored[found->second];
      entry.row = entry.stored->row;
      used[found->second] = true;
    } else {
      entry.row = std::max(next_row, end_row);
    }
    if (entry.row < next_row || entry.row - first_row > 0xffffffff) return PlanAnew(ids, stored, first_row);
    next_row = entry.row + 1;
    plan.entries.push_back(entry);
  }
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (!used[i]) plan.removed.push_back(stored[i].row);
  }
  return plan;
}

}  // namespace slamdb::sqlite
