// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "slamdb/model/atlas.h"

// Columns of an atlas as numpy arrays over the same memory.
namespace slamdb::python {

// To be called, with the GIL held, before anything else of pybind11's arrays: numpy is imported with the first one. Of
// threads that come here at once one imports it and the others wait without the GIL, which it takes to do so.
void RequireNumpy();

template <class Number>
pybind11::dtype TypeOf() {
  RequireNumpy();
  return pybind11::dtype::of<Number>();
}

// To be filled.
template <class Number>
pybind11::array_t<Number> NewArray(std::vector<pybind11::ssize_t> shape) {
  RequireNumpy();
  return pybind11::array_t<Number>(std::move(shape));
}

// An argument as the array that it is, or makes; null where it makes none.
pybind11::array ArrayOrNull(pybind11::handle object);

// What keeps the memory of an array alive.
using Kept = std::shared_ptr<const void>;

// Where the elements of an array lie: `shape` and `strides` (bytes) as numpy has them.
struct ArrayPlace {
  const void* data = nullptr;
  std::vector<pybind11::ssize_t> shape, strides;
};

// An array over that memory, without a copy. Writing to it changes the atlas unless it is read-only.
pybind11::array ViewOf(const Kept& kept, const pybind11::dtype& type, ArrayPlace place);

// Nothing may be written to it: it is computed, or must stay consistent with what else the atlas holds.
pybind11::array ReadOnly(pybind11::array array);

// A column of numbers, ids, keypoints or descriptors that stand one behind the other.
template <class Number, class Element>
pybind11::array ColumnView(const Kept& kept, const Column<Element>& column) {
  static_assert(sizeof(Element) % sizeof(Number) == 0);
  constexpr pybind11::ssize_t kEach = sizeof(Element) / sizeof(Number);
  ArrayPlace place{column.data(), {static_cast<pybind11::ssize_t>(column.size())}, {sizeof(Element)}};
  if (kEach > 1) {
    place.shape.push_back(kEach);
    place.strides.push_back(sizeof(Number));
  }
  return ViewOf(kept, TypeOf<Number>(), std::move(place));
}

// One member of all entities, of `width` numbers each; 1: an array of one dimension. `member` is a pointer to it, or
// gives a reference to it.
template <class Number, class Entities, class Member>
pybind11::array MemberView(const Kept& kept, const Entities& entities, const Member& member,
                           pybind11::ssize_t width = 1) {
  ArrayPlace place{entities.empty() ? nullptr : &std::invoke(member, entities.front()),
                   {static_cast<pybind11::ssize_t>(entities.size())},
                   {sizeof(typename Entities::value_type)}};
  if (width > 1) {
    place.shape.push_back(width);
    place.strides.push_back(sizeof(Number));
  }
  return ViewOf(kept, TypeOf<Number>(), std::move(place));
}

// An array of values that are computed, one for each entity.
template <class Value, class Entity, class Compute>
pybind11::array Computed(const Column<Entity>& entities, Compute compute) {
  auto values = NewArray<Value>({static_cast<pybind11::ssize_t>(entities.size())});
  Value* at = values.mutable_data();
  for (const Entity& entity : entities) *at++ = compute(entity);
  return ReadOnly(std::move(values));
}

// Three numbers of one entity.
inline pybind11::array PositionView(const Kept& kept, Eigen::Vector3f& position) {
  return ViewOf(kept, TypeOf<float>(), {position.data(), {3}, {sizeof(float)}});
}

// Copies a vector into an array of its own.
template <class Value>
pybind11::array ArrayOf(const std::vector<Value>& values) {
  auto array = NewArray<Value>({static_cast<pybind11::ssize_t>(values.size())});
  std::copy(values.begin(), values.end(), array.mutable_data());
  return ReadOnly(std::move(array));
}

}  // namespace slamdb::python
