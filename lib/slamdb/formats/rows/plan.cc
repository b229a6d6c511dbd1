// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/plan.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "slamdb/base/error.h"
#include "slamdb/model/index.h"

namespace slamdb::rows {
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

// What an entry of the list is to the store.
struct Match {
  bool unique = true;
  std::size_t stored = kNoRow;  // index of its row
};

// By id and occurrence.
std::vector<Match> MatchAny(std::span<const std::int64_t> ids, std::span<const StoredRow> stored) {
  std::unordered_map<Key, std::size_t, KeyHash> by_key(stored.size());
  Occurrences stored_occurrences(stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) by_key.emplace(stored_occurrences.Next(stored[i].id), i);
  std::vector<Match> matches;
  matches.reserve(ids.size());
  Occurrences occurrences(ids.size());
  for (const std::int64_t id : ids) {
    const Key key = occurrences.Next(id);
    const auto found = by_key.find(key);
    matches.push_back({IsUnique(key), found == by_key.end() ? kNoRow : found->second});
  }
  return matches;
}

// id_of(row) -> row for rows 0, 1, ...; nothing when an id occurs twice or is `none`.
std::optional<IdTable> TableOfDistinct(std::size_t count, const auto& id_of) {
  std::uint64_t lowest = Id<Map>::kNone, highest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    lowest = std::min(lowest, static_cast<std::uint64_t>(id_of(i)));
    highest = std::max(highest, static_cast<std::uint64_t>(id_of(i)));
  }
  if (highest == Id<Map>::kNone) return std::nullopt;
  IdTable table(std::min(lowest, highest), highest, count);
  for (std::size_t i = 0; i < count; ++i)
    if (table.Insert(static_cast<std::uint64_t>(id_of(i)), static_cast<std::uint32_t>(i)) != kNoRow)
      return std::nullopt;
  return table;
}

// The same; much faster where every id is there once, as in sound atlases.
std::vector<Match> MatchRows(std::span<const std::int64_t> ids, std::span<const StoredRow> stored) {
  const auto stored_table = TableOfDistinct(stored.size(), [&](std::size_t i) { return stored[i].id; });
  if (!stored_table || !TableOfDistinct(ids.size(), [&](std::size_t i) { return ids[i]; }))
    return MatchAny(ids, stored);
  std::vector<Match> matches;
  matches.reserve(ids.size());
  for (const std::int64_t id : ids) matches.push_back({true, stored_table->Find(static_cast<std::uint64_t>(id))});
  return matches;
}

}  // namespace

ListPlan PlanList(std::span<const std::int64_t> ids, std::span<const StoredRow> stored, std::int64_t first_row) {
  constexpr std::int64_t kMost = 0xffffffff;
  ListPlan plan;
  plan.entries.reserve(ids.size());
  std::vector<bool> used(stored.size());
  std::int64_t next_row = stored.empty() ? first_row : stored.back().row + 1;
  for (const Match& match : MatchRows(ids, stored)) {
    if (match.stored == kNoRow) {
      plan.entries.push_back({next_row++, match.unique, nullptr});
      continue;
    }
    used[match.stored] = true;
    plan.entries.push_back({stored[match.stored].row, match.unique, &stored[match.stored]});
  }
  if (next_row - first_row > kMost)
    throw Error(
        ErrorKind::kNotPossible,
        "a map with more than 4294967295 keyframes or points, those that it had before included, does not fit a "
        "store: save it under another name");
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (!used[i]) plan.removed.push_back(stored[i].row);
  }
  return plan;
}

}  // namespace slamdb::rows
