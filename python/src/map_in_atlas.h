// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <type_traits>

#include "python/src/arrays.h"
#include "python/src/held_atlas.h"
#include "slamdb/base/error.h"

namespace slamdb::python {

// A map of a Python Atlas: it shows what the atlas is now, whatever has changed since it was asked for.
struct MapInAtlas {
  std::shared_ptr<HeldAtlas> atlas;
  std::size_t row = 0;
  MapId id;

  // Throws Error (kNotFound) when it is gone.
  Map& In(Atlas& value) const {
    if (row < value.maps.size() && value.maps[row].id == id) return value.maps[row];
    throw Error(ErrorKind::kNotFound, ToString(id) + " is no longer in the atlas at its place: ask for it again");
  }
  // Of the value as it is now, which it keeps: other threads may put another in its place meanwhile.
  std::shared_ptr<Map> map() const {
    const std::shared_ptr<Atlas>& value = atlas->value();
    return {value, &In(*value)};
  }
};

// Its keyframes, or its points.
template <auto List>
struct EntitiesInMap {
  MapInAtlas of;
  auto list() const {
    const std::shared_ptr<Map> map = of.map();
    return std::shared_ptr<std::remove_reference_t<decltype((*map).*List)>>(map, &((*map).*List));
  }
};
using KeyFramesInMap = EntitiesInMap<&Map::keyframes>;
using PointsInMap = EntitiesInMap<&Map::points>;

// What makes an array over a member of all of them, of `width` numbers each.
template <class Entities, class Number, class Member>
auto MembersOf(const Member& member, pybind11::ssize_t width = 1) {
  return [member, width](const Entities& entities) {
    const auto list = entities.list();
    return MemberView<Number>(list, *list, member, width);
  };
}
// The same of what must stay consistent: ids, links, and what is counted from them. Nothing may be written to it.
template <class Entities, class Number, class Member>
auto FixedMembersOf(const Member& member, pybind11::ssize_t width = 1) {
  return [view = MembersOf<Entities, Number>(member, width)](const Entities& entities) {
    return ReadOnly(view(entities));
  };
}

template <class Entity>
using EntitiesOf = std::conditional_t<std::is_same_v<Entity, KeyFrame>, KeyFramesInMap, PointsInMap>;
template <class Number, class Entity, class Member>
auto Members(Member Entity::*member, pybind11::ssize_t width = 1) {
  return MembersOf<EntitiesOf<Entity>, Number>(member, width);
}
template <class Number, class Entity, class Member>
auto FixedMembers(Member Entity::*member) {
  return FixedMembersOf<EntitiesOf<Entity>, Number>(member);
}

// A flag of all of them, computed.
template <auto Member, class Entities>
pybind11::array FlagsOf(const Entities& entities) {
  return Computed<bool>(*entities.list(), [](const auto& entity) { return static_cast<bool>(entity.*Member); });
}

// The row that a Python index means, which counts from the end where it is negative.
inline std::size_t RowAt(pybind11::ssize_t index, std::size_t size) {
  if (index < 0) index += static_cast<pybind11::ssize_t>(size);
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    throw pybind11::index_error("there are " + std::to_string(size));
  return static_cast<std::size_t>(index);
}

// An entity by itself: the row of an atlas that `kept` keeps.
template <class Entity>
struct Row {
  Kept kept;
  Entity* entity = nullptr;
};
template <class Entity>
Row<Entity> RowOf(const std::shared_ptr<Column<Entity>>& list, pybind11::ssize_t index) {
  return {list, &(*list)[RowAt(index, list->size())]};
}

// None, where an id is none.
template <class Entity>
pybind11::object IdOrNone(Id<Entity> id) {
  return id ? pybind11::object(pybind11::int_(id.value())) : pybind11::object(pybind11::none());
}

}  // namespace slamdb::python
