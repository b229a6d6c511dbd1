// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/journal.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/detail/entity_changes.h"
#include "slamdb/edit/repair/detail/field_bits.h"
#include "slamdb/model/digest.h"

namespace slamdb {
namespace {

using field_bits::BitsOf;
using field_bits::ChangesOf;
using field_bits::ElementAt;
using field_bits::SizeOf;

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
      FailMisfit("an atlas cannot be removed or added");
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

// Takes the entities of `additions` out again, whose rows descend, and that are as they were when they were put in.
template <class List>
void TakeOut(std::span<const EntityEdit* const> additions, List& list) {
  std::vector<std::uint8_t> is_out(list.size(), 0);
  for (const EntityEdit* addition : additions) {
    auto& entity = RowOf(list, *addition);
    TakeBackFields(*addition, entity);
    if (!ChangesOf(std::remove_cvref_t<decltype(entity)>(), entity).empty())
      FailMisfit("row " + std::to_string(addition->row) + " is not what was added");
    is_out[addition->row] = 1;
  }
  List rest;
  rest.reserve(list.size() - additions.size());
  for (std::size_t row = 0; row < list.size(); ++row)
    if (is_out[row] == 0) rest.push_back(std::move(list[row]));
  list = std::move(rest);
}

// Whether `b`, which stands before `a` in the journal, is taken back together with it.
bool AreOneStep(const EntityEdit& a, const EntityEdit& b) {
  if (a.kind != b.kind || a.map != b.map || a.removed != b.removed || a.added != b.added) return false;
  return a.removed ? a.row < b.row : a.row > b.row;
}

}  // namespace

// What one list lost is put back together, and so is taken out what it got: many of them do not move the list as often.
void TakeBack(const Journal& journal, Atlas& atlas) {
  const auto end = journal.edits.rend();
  for (auto edit = journal.edits.rbegin(); edit != end;) {
    if (!edit->removed && !edit->added) {
      if (edit->kind == EntityKind::kAtlas)
        TakeBackFields(*edit, atlas);
      else
        WithList(atlas, *edit, [&](auto& list) { TakeBackFields(*edit, RowOf(list, *edit)); });
      ++edit;
      continue;
    }
    std::vector<const EntityEdit*> step;
    do step.push_back(&*edit++);
    while (edit != end && AreOneStep(*step.back(), *edit));
    WithList(atlas, *step.front(),
             [&](auto& list) { step.front()->removed ? Insert(step, list) : TakeOut(step, list); });
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
