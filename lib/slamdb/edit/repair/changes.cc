// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "slamdb/edit/repair/detail/entity_changes.h"
#include "slamdb/edit/repair/journal.h"

namespace slamdb {
namespace {

using field_bits::ChangesOf;
using Flags = std::vector<std::uint8_t>;

// Which rows of two lists are the same entities, in order.
struct Kept {
  Flags before, after;
};

// When rows were taken out only. `key` tells entities apart.
template <class List, class Key>
std::optional<Kept> KeptOfShrunk(const List& before, const List& after, const Key& key) {
  Kept kept{Flags(before.size(), 0), Flags(after.size(), 1)};
  std::size_t next = 0;
  for (std::size_t row = 0; row < before.size() && next < after.size(); ++row) {
    kept.before[row] = key(before[row]) == key(after[next]);
    next += kept.before[row];
  }
  return next == after.size() ? std::optional(std::move(kept)) : std::nullopt;
}

// Rows may have been put in, too; what was moved counts as taken out and put in.
template <class List, class Key>
Kept KeptOfMixed(const List& before, const List& after, const Key& key) {
  Kept kept{Flags(before.size(), 0), Flags(after.size(), 0)};
  std::map<decltype(key(before[0])), std::size_t> to_come;
  for (const auto& entity : after) ++to_come[key(entity)];
  const auto is_gone = [&](const auto& entity) {
    const auto found = to_come.find(key(entity));
    return found == to_come.end() || found->second == 0;
  };
  std::size_t old = 0;
  for (std::size_t row = 0; row < after.size(); ++row) {
    const auto id = key(after[row]);
    --to_come[id];
    while (old < before.size() && key(before[old]) != id && is_gone(before[old])) ++old;
    if (old < before.size() && key(before[old]) == id) kept.before[old++] = kept.after[row] = 1;
  }
  return kept;
}

// Lists of one length have the same entities row by row.
template <class List, class Key>
Kept KeptOf(const List& before, const List& after, const Key& key) {
  if (before.size() == after.size()) return {Flags(before.size(), 1), Flags(after.size(), 1)};
  if (auto kept = KeptOfShrunk(before, after, key)) return *std::move(kept);
  return KeptOfMixed(before, after, key);
}

// Compares an atlas with what became of it, list by list. In each, removals come first, from the end on, so that rows
// mean the list as it is at that moment; then additions from the beginning on, then changes.
class Comparison {
 public:
  Comparison(std::string_view rule, Journal& journal) : rule_(rule), journal_(journal) {}

  void Run(const Atlas& before, const Atlas& after) {
    CompareList(EntityKind::kCamera, 0, before.cameras, after.cameras);
    CompareMaps(before.maps, after.maps);
    Add(EntityKind::kAtlas, 0, 0, 0, ChangesOf(before, after));
  }

 private:
  // Maps that share an id are told apart by their lists.
  void CompareMaps(const std::vector<Map>& before, const std::vector<Map>& after) {
    std::set<MapId> ids;
    for (const Map& map : before) ids.insert(map.id);
    const auto key = [by_lists = ids.size() < before.size()](const Map& map) {
      return std::tuple(map.id, by_lists ? map.keyframes.size() : 0, by_lists ? map.points.size() : 0);
    };
    const Kept kept = KeptOf(before, after, key);
    for (std::size_t row = before.size(); row-- > 0;) {
      if (kept.before[row] != 0) continue;
      CompareLists(row, before[row], {});
      Remove(EntityKind::kMap, 0, row, before[row]);
    }
    for (std::size_t row = 0; row < after.size(); ++row) {
      if (kept.after[row] != 0) continue;
      PutIn(EntityKind::kMap, 0, row, after[row]);
      CompareLists(row, {}, after[row]);
    }
    ForEachKept(kept, [&](std::size_t old, std::size_t row) {
      CompareLists(row, before[old], after[row]);
      Add(EntityKind::kMap, 0, row, before[old].id.value(), ChangesOf(before[old], after[row]));
    });
  }

  void CompareLists(std::size_t row, const Map& before, const Map& after) {
    const auto map = static_cast<std::uint32_t>(row);
    CompareList(EntityKind::kKeyFrame, map, before.keyframes, after.keyframes);
    CompareList(EntityKind::kPoint, map, before.points, after.points);
    CompareList(EntityKind::kLandmark, map, before.landmarks, after.landmarks);
  }

  template <class List>
  void CompareList(EntityKind kind, std::uint32_t map, const List& before, const List& after) {
    const Kept kept = KeptOf(before, after, [](const auto& entity) { return entity.id; });
    for (std::size_t row = before.size(); row-- > 0;)
      if (kept.before[row] == 0) Remove(kind, map, row, before[row]);
    for (std::size_t row = 0; row < after.size(); ++row)
      if (kept.after[row] == 0) PutIn(kind, map, row, after[row]);
    ForEachKept(kept, [&](std::size_t old, std::size_t row) {
      Add(kind, map, row, before[old].id.value(), ChangesOf(before[old], after[row]));
    });
  }

  template <class Use>
  static void ForEachKept(const Kept& kept, const Use& use) {
    std::size_t old = 0;
    for (std::size_t row = 0; row < kept.after.size(); ++row) {
      if (kept.after[row] == 0) continue;
      while (kept.before[old] == 0) ++old;
      use(old++, row);
    }
  }

  EntityEdit EditOf(EntityKind kind, std::uint32_t map, std::size_t row, std::uint64_t id) const {
    return {.rule = std::string(rule_), .kind = kind, .map = map, .row = row, .id = id};
  }
  void Add(EntityKind kind, std::uint32_t map, std::size_t row, std::uint64_t id, std::vector<FieldEdit> fields) {
    if (fields.empty()) return;
    journal_.edits.push_back(EditOf(kind, map, row, id));
    journal_.edits.back().fields = std::move(fields);
  }
  template <class Entity>
  void Remove(EntityKind kind, std::uint32_t map, std::size_t row, const Entity& entity) {
    EntityEdit& edit = journal_.edits.emplace_back(EditOf(kind, map, row, entity.id.value()));
    edit.removed = true;
    edit.fields = ChangesOf(entity, Entity());
  }
  template <class Entity>
  void PutIn(EntityKind kind, std::uint32_t map, std::size_t row, const Entity& entity) {
    EntityEdit& edit = journal_.edits.emplace_back(EditOf(kind, map, row, entity.id.value()));
    edit.added = true;
    edit.fields = ChangesOf(Entity(), entity);
  }

  std::string_view rule_;
  Journal& journal_;
};

}  // namespace

void AppendChanges(const Atlas& before, const Atlas& after, std::string_view rule, Journal& journal) {
  Comparison(rule, journal).Run(before, after);
}

}  // namespace slamdb
