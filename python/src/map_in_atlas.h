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

  const Kept& kept() const { return atlas->value(); }
  // Throws Error (kNotFound) when it is gone.
  Map& map() const {
    std::vector<Map>& maps = kept()->maps;
    if (row < maps.size() && maps[row].id == id) return maps[row];
    throw Error(ErrorKind::kNotFound, ToString(id) + " is no longer in the atlas at its place: ask for it again");
  }
};

// Its keyframes, or its points.
template <class Entity, auto List>
struct EntitiesInMap {
  MapInAtlas of;
  Column<Entity>& list() const { return of.map().*List; }
};
using KeyFramesInMap = EntitiesInMap<KeyFrame, &Map::keyframes>;
using PointsInMap = EntitiesInMap<MapPoint, &Map::points>;

// What makes an array over a member of all of them, of `width` numbers each.
template <class Entities, class Number, class Member>
auto MembersOf(const Member& member, pybind11::ssize_t width = 1) {
  return [member, width](const Entities& entities) {
    return MemberView<Number>(entities.of.kept(), entities.list(), member, width);
  };
}
template <class Number, class Entity, class Member>
auto Members(Member Entity::*member, pybind11::ssize_t width = 1) {
  using Entities = std::conditional_t<std::is_same_v<Entity, KeyFrame>, KeyFramesInMap, PointsInMap>;
  return MembersOf<Entities, Number>(member, width);
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

// None, where an id is none.
template <class Entity>
pybind11::object IdOrNone(Id<Entity> id) {
  return id ? pybind11::object(pybind11::int_(id.value())) : pybind11::object(pybind11::none());
}

}  // namespace slamdb::python
