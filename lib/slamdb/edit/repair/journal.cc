// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/journal.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <tuple>
#include <unordered_map>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/detail/field_bits.h"
#include "slamdb/model/digest.h"

namespace slamdb {
namespace {

using field_bits::ElementAt;
using field_bits::SameElement;
using field_bits::SizeOf;

// ---- What changed

template <class Field>
std::vector<std::uint64_t> BitsOf(const Field& field, std::size_t begin, std::size_t end) {
  std::vector<std::uint64_t> bits;
  for (std::size_t i = begin; i < end; ++i) field_bits::AppendBits(ElementAt(field, i), bits);
  return bits;
}

// In fields of equal length every run of elements that differ is an edit; otherwise what lies between the common
// beginning and the common end is one.
template <class Field>
void AppendFieldChanges(std::string_view name, const Field& before, const Field& after, std::vector<FieldEdit>& edits) {
  const auto differs = [&](std::size_t i, std::size_t j) {
    return !SameElement(ElementAt(before, i), ElementAt(after, j));
  };
  const auto add = [&](std::size_t begin, std::size_t before_end, std::size_t after_end) {
    edits.push_back({std::string(name), field_bits::KindsOf<Field>(), begin, BitsOf(before, begin, before_end),
                     BitsOf(after, begin, after_end)});
  };
  std::size_t before_end = SizeOf(before), after_end = SizeOf(after), begin = 0;
  if (before_end == after_end) {
    for (; begin < before_end; ++begin) {
      if (!differs(begin, begin)) continue;
      const std::size_t first = begin;
      while (begin < before_end && differs(begin, begin)) ++begin;
      add(first, begin, begin);
    }
    return;
  }
  while (begin < std::min(before_end, after_end) && !differs(begin, begin)) ++begin;
  for (; before_end > begin && after_end > begin && !differs(before_end - 1, after_end - 1); --before_end) --after_end;
  add(begin, before_end, after_end);
}

template <class Field>
requires field_bits::kIsRecord<Field>
void AppendFieldChanges(std::string_view name, const Field& before, const Field& after, std::vector<FieldEdit>& edits) {
  AppendFieldChanges(name, field_bits::BytesOf(before), field_bits::BytesOf(after), edits);
}

template <class Entity>
std::vector<FieldEdit> ChangesOf(const Entity& before, const Entity& after) {
  std::vector<FieldEdit> edits;
  ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... members) {
    const auto &one = Member(before, members...), &other = Member(after, members...);
    if (!field_bits::SameField(one, other)) AppendFieldChanges(name, one, other, edits);
  });
  return edits;
}

// Which rows of `before` are still there, when rows can only have been taken out. `key` tells entities apart.
template <class List, class Key>
std::vector<std::uint8_t> RowsKept(const List& before, const List& after, const Key& key) {
  std::vector<std::uint8_t> kept(before.size(), before.size() == after.size());
  if (before.size() == after.size()) return kept;
  std::size_t next = 0;
  for (std::size_t row = 0; row < before.size() && next < after.size(); ++row) {
    kept[row] = key(before[row]) == key(after[next]);
    next += kept[row];
  }
  if (next != after.size())
    throw Error(ErrorKind::kNotPossible, "entities were added or moved: such a change cannot be taken back");
  return kept;
}

constexpr auto kIdOf = [](const auto& entity) { return entity.id; };

// Which rows of two lists are the same entities, in order.
struct Kept {
  std::vector<std::uint8_t> before, after;
};

template <class List>
Kept KeptOf(const List& before, const List& after) {
  return {RowsKept(before, after, kIdOf), std::vector<std::uint8_t>(after.size(), 1)};
}

// Landmarks may be added too: those of equal id are the same, or of equal row where nothing was added or removed.
Kept KeptOf(const std::vector<Landmark>& before, const std::vector<Landmark>& after) {
  const bool as_they_were = before.size() == after.size();
  Kept kept{std::vector<std::uint8_t>(before.size(), as_they_were),
            std::vector<std::uint8_t>(after.size(), as_they_were)};
  if (as_they_were) return kept;
  std::unordered_map<LandmarkId, std::size_t> to_come;
  for (const Landmark& landmark : after) ++to_come[landmark.id];
  std::size_t old = 0;
  for (std::size_t row = 0; row < after.size(); ++row) {
    --to_come[after[row].id];
    while (old < before.size() && before[old].id != after[row].id && to_come[before[old].id] == 0) ++old;
    if (old == before.size() || before[old].id != after[row].id) continue;
    kept.before[old++] = kept.after[row] = 1;
  }
  return kept;
}

// Compares an atlas with what became of it, list by list. In each, removals come first, from the end on, so that rows
// mean the list as it is at that moment.
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
    const std::vector<std::uint8_t> kept = RowsKept(before, after, key);
    for (std::size_t row = before.size(); row-- > 0;) {
      if (kept[row] != 0) continue;
      const auto map = static_cast<std::uint32_t>(row);
      CompareList(EntityKind::kKeyFrame, map, before[row].keyframes, {});
      CompareList(EntityKind::kPoint, map, before[row].points, {});
      CompareList(EntityKind::kLandmark, map, before[row].landmarks, {});
      Remove(EntityKind::kMap, 0, row, before[row]);
    }
    std::size_t row = 0;
    for (std::size_t old = 0; old < before.size(); ++old) {
      if (kept[old] == 0) continue;
      const auto map = static_cast<std::uint32_t>(row);
      CompareList(EntityKind::kKeyFrame, map, before[old].keyframes, after[row].keyframes);
      CompareList(EntityKind::kPoint, map, before[old].points, after[row].points);
      CompareList(EntityKind::kLandmark, map, before[old].landmarks, after[row].landmarks);
      Add(EntityKind::kMap, 0, row, before[old].id.value(), ChangesOf(before[old], after[row]));
      ++row;
    }
  }

  // Removals, then additions from the beginning on, then changes.
  template <class List>
  void CompareList(EntityKind kind, std::uint32_t map, const List& before, const List& after) {
    const Kept kept = KeptOf(before, after);
    for (std::size_t row = before.size(); row-- > 0;)
      if (kept.before[row] == 0) Remove(kind, map, row, before[row]);
    for (std::size_t row = 0; row < after.size(); ++row)
      if (kept.after[row] == 0)
        journal_.edits.push_back({.rule = std::string(rule_),
                                  .kind = kind,
                                  .map = map,
                                  .row = row,
                                  .id = after[row].id.value(),
                                  .added = true,
                                  .fields = ChangesOf(typename List::value_type(), after[row])});
    std::size_t old = 0;
    for (std::size_t row = 0; row < after.size(); ++row) {
      if (kept.after[row] == 0) continue;
      while (kept.before[old] == 0) ++old;
      Add(kind, map, row, before[old].id.value(), ChangesOf(before[old], after[row]));
      ++old;
    }
  }

  void Add(EntityKind kind, std::uint32_t map, std::size_t row, std::uint64_t id, std::vector<FieldEdit> fields) {
    if (fields.empty()) return;
    journal_.edits.push_back(
        {.rule = std::string(rule_), .kind = kind, .map = map, .row = row, .id = id, .fields = std::move(fields)});
  }
  template <class Entity>
  void Remove(EntityKind kind, std::uint32_t map, std::size_t row, const Entity& entity) {
    journal_.edits.push_back({.rule = std::string(rule_),
                              .kind = kind,
                              .map = map,
                              .row = row,
                              .id = entity.id.value(),
                              .removed = true,
                              .fields = ChangesOf(entity, Entity())});
  }

  std::string_view rule_;
  Journal& journal_;
};

// ---- And back

[[noreturn]] void FailMisfit(std::string_view what) {
  throw Error(ErrorKind::kNotPossible, "the journal is not of this atlas: " + std::string(what));
}

template <class Element>
Element ElementFrom(const std::uint64_t* bits) {
  Element element{};
  field_bits::ForEachScalar(element, [&](auto& scalar) { field_bits::FromBits(*bits++, scalar); });
  return element;
}

template <class Field>
void TakeBackField(const FieldEdit& edit, Field& field) {
  const std::string kinds = field_bits::KindsOf<Field>();
  if (edit.kinds != kinds) FailMisfit("field " + edit.field + " holds " + kinds + ", not " + edit.kinds);
  const std::size_t width = kinds.size();
  const std::size_t before = edit.before.size() / width, after = edit.after.size() / width;
  if (edit.at > SizeOf(field) || after > SizeOf(field) - edit.at ||
      BitsOf(field, edit.at, edit.at + after) != edit.after)
    FailMisfit("field " + edit.field + " does not hold what it was changed to");
  if constexpr (field_bits::kIsSequence<Field>) {
    using Element = typename Field::value_type;
    const auto first = field.begin() + static_cast<std::ptrdiff_t>(edit.at);
    std::vector<Element> elements;
    for (std::size_t i = 0; i < before; ++i) elements.push_back(ElementFrom<Element>(&edit.before[i * width]));
    const auto shared = static_cast<std::ptrdiff_t>(std::min(before, after));
    std::copy_n(elements.begin(), shared, first);
    if (after > before)
      field.erase(first + shared, first + static_cast<std::ptrdiff_t>(after));
    else
      field.insert(first + shared, elements.begin() + shared, elements.end());
  } else {
    if (before != after) FailMisfit("field " + edit.field + " is no list");
    for (std::size_t i = 0; i < before; ++i) {
      auto& element = ElementAt(field, edit.at + i);
      element = ElementFrom<std::remove_cvref_t<decltype(element)>>(&edit.before[i * width]);
    }
  }
}

template <class Field>
requires field_bits::kIsRecord<Field>
void TakeBackField(const FieldEdit& edit, Field& field) {
  std::vector<std::uint8_t> bytes = field_bits::BytesOf(field);
  TakeBackField(edit, bytes);
  field_bits::FromBytes(bytes, field);
}

template <class Entity>
void TakeBackFields(const EntityEdit& edit, Entity& entity) {
  for (auto field = edit.fields.rbegin(); field != edit.fields.rend(); ++field) {
    bool found = false;
    ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... members) {
      if (found || name != field->field) return;
      found = true;
      TakeBackField(*field, Member(entity, members...));
    });
    if (!found) FailMisfit("there is no field " + field->field);
  }
}

template <class List>
auto& RowOf(List& list, const EntityEdit& edit) {
  if (edit.row >= list.size()) FailMisfit("it has no row " + std::to_string(edit.row));
  return list[edit.row];
}

Map& MapOf(Atlas& atlas, const EntityEdit& edit) {
  if (edit.map >= atlas.maps.size()) FailMisfit("it has no map in row " + std::to_string(edit.map));
  return atlas.maps[edit.map];
}

// Calls use(list) with the list that an edit is about.
template <class Use>
void WithList(Atlas& atlas, const EntityEdit& edit, const Use& use) {
  switch (edit.kind) {
    case EntityKind::kCamera:
      return use(atlas.cameras);
    case EntityKind::kMap:
      return use(atlas.maps);
    case EntityKind::kKeyFrame:
      return use(MapOf(atlas, edit).keyframes);
    case EntityKind::kPoint:
      return use(MapOf(atlas, edit).points);
    case EntityKind::kLandmark:
      return use(MapOf(atlas, edit).landmarks);
    case EntityKind::kAtlas:
      FailMisfit("an atlas cannot be removed");
  }
}

// Puts the entities of `removals` back, whose rows ascend.
template <class List>
void Insert(std::span<const EntityEdit* const> removals, List& list) {
  List whole;
  whole.reserve(list.size() + removals.size());
  auto rest = list.begin();
  for (const EntityEdit* removal : removals) {
    while (whole.size() < removal->row && rest != list.end()) whole.push_back(std::move(*rest++));
    if (whole.size() != removal->row) FailMisfit("it has no row " + std::to_string(removal->row));
    TakeBackFields(*removal, whole.emplace_back());
  }
  std::move(rest, list.end(), std::back_inserter(whole));
  list = std::move(whole);
}

// Takes an entity out again that an edit has put in, and that is as it was then.
template <class List>
void TakeOut(const EntityEdit& edit, List& list) {
  auto& entity = RowOf(list, edit);
  TakeBackFields(edit, entity);
  if (!ChangesOf(std::remove_cvref_t<decltype(entity)>(), entity).empty())
    FailMisfit("row " + std::to_string(edit.row) + " is not what was added");
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(edit.row));
}

bool OfOneList(const EntityEdit& a, const EntityEdit& b) {
  return b.removed && a.kind == b.kind && a.map == b.map && a.row < b.row;
}

}  // namespace

void AppendChanges(const Atlas& before, const Atlas& after, std::string_view rule, Journal& journal) {
  Comparison(rule, journal).Run(before, after);
}

// Removals from one list are taken back together, so that many of them do not move the list as often.
void TakeBack(const Journal& journal, Atlas& atlas) {
  const auto end = journal.edits.rend();
  for (auto edit = journal.edits.rbegin(); edit != end;) {
    if (!edit->removed) {
      if (edit->kind == EntityKind::kAtlas)
        TakeBackFields(*edit, atlas);
      else if (edit->added)
        WithList(atlas, *edit, [&](auto& list) { TakeOut(*edit, list); });
      else
        WithList(atlas, *edit, [&](auto& list) { TakeBackFields(*edit, RowOf(list, *edit)); });
      ++edit;
      continue;
    }
    std::vector<const EntityEdit*> removals;
    do removals.push_back(&*edit++);
    while (edit != end && OfOneList(*removals.back(), *edit));
    WithList(atlas, *removals.front(), [&](auto& list) { Insert(removals, list); });
  }
}

UndoReport UndoRepair(Atlas& atlas, const Journal& journal, const UndoOptions& options) {
  detail::Steps steps(options.progress, "taking back edits", 3);
  if (HashWithoutEncoding(atlas, options.threads) != journal.repaired)
    throw Error(ErrorKind::kNotPossible, "is not the atlas that the journal was kept of; its content differs");
  steps.Next();
  TakeBack(journal, atlas);
  atlas.encoding = journal.encoding;
  steps.Next();
  if (HashWithoutEncoding(atlas, options.threads) != journal.original)
    throw Error(ErrorKind::kDamaged, "the journal does not lead back to the original: it was changed");
  steps.Next();
  return {.edits = journal.edits.size()};
}

}  // namespace slamdb
