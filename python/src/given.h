// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/model/ids.h"
#include "slamdb/model/rigid.h"

// Arguments of calls that are arrays. What is wrong with one is an Error (kUsage) that begins with its name.
namespace slamdb::python {

using Shape = std::vector<pybind11::ssize_t>;  // -1: as many as there are

[[noreturn]] inline void RefuseGiven(const std::string& name, const std::string& problem) {
  throw Error(ErrorKind::kUsage, name + ": " + problem);
}

template <class Number>
using Contiguous = pybind11::array_t<Number, pybind11::array::c_style | pybind11::array::forcecast>;

// As an array of any numbers of that shape; of no rows where it is empty and may be.
pybind11::array GivenNumbers(pybind11::handle object, const std::string& name, const Shape& shape);
// The same of whole numbers.
pybind11::array GivenIntegers(pybind11::handle object, const std::string& name, const Shape& shape);

// Its numbers in that type. Of whole ones that do not fit the row is told.
template <class Number>
Contiguous<Number> GivenAs(pybind11::handle object, const std::string& name, const Shape& shape) {
  return GivenNumbers(object, name, shape);
}
template <>
Contiguous<std::int32_t> GivenAs(pybind11::handle object, const std::string& name, const Shape& shape);
template <>
Contiguous<std::uint64_t> GivenAs(pybind11::handle object, const std::string& name, const Shape& shape);

// Ids, or rows; of None none.
std::vector<std::uint64_t> GivenIds(pybind11::handle object, const std::string& name, const Shape& shape = {-1});

// A list of elements that are `sizeof(Element) / sizeof(Number)` numbers each; of None none, where that may be.
template <class Element, class Number, class List = std::vector<Element>>
List GivenElements(pybind11::handle object, const std::string& name, const Shape& shape) {
  if (object.is_none() && shape.front() <= 0) return {};
  const auto array = GivenAs<Number>(object, name, shape);
  const auto* begin = reinterpret_cast<const Element*>(array.data());
  return List(begin, begin + static_cast<std::size_t>(array.size()) * sizeof(Number) / sizeof(Element));
}

template <class Entity>
std::vector<Id<Entity>> GivenIdsOf(pybind11::handle object, const std::string& name) {
  std::vector<Id<Entity>> ids;
  for (const std::uint64_t id : GivenIds(object, name)) ids.emplace_back(id);
  return ids;
}

// One number; with `Number` std::int32_t or std::uint64_t a whole one.
template <class Number>
Number GivenNumber(pybind11::handle object, const std::string& name) {
  return *GivenAs<Number>(object, name, {}).data();
}
// Of None no id.
template <class Entity>
Id<Entity> GivenId(pybind11::handle object, const std::string& name) {
  return object.is_none() ? Id<Entity>() : Id<Entity>(GivenNumber<std::uint64_t>(object, name));
}

// A rigid transform, (4, 4).
Rigid3f GivenTransform(pybind11::handle object, const std::string& name);

// What is in a sequence, as it is now.
pybind11::tuple GivenItems(pybind11::handle object, const std::string& name);

// Throws Error (kUsage) when values of a masked array are masked: there is no number then.
void RequireUnmasked(pybind11::handle object, const std::string& name);

// A member of a mapping, or an attribute; None where there is none.
pybind11::object PartOf(pybind11::handle object, const char* name);

}  // namespace slamdb::python
