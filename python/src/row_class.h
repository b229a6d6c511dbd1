// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "python/src/map_in_atlas.h"

// What lists of rows, and rows, are as Python's containers and members of such.
namespace slamdb::python {

// Whose `key` (pointer, number) is the same are equal. It must be of something that they keep alive.
template <class Class, class Key>
void DefineIdentity(Class& defined, const Key& key) {
  using Value = typename Class::type;
  defined
      .def("__eq__",
           [key](const Value& one, const pybind11::object& other) {
             if (!pybind11::isinstance<Value>(other))
               return pybind11::reinterpret_borrow<pybind11::object>(Py_NotImplemented);
             return pybind11::object(pybind11::bool_(key(one) == key(other.cast<const Value&>())));
           })
      .def("__hash__", [key](const Value& one) {
        const auto [pointer, number] = key(one);
        return std::hash<const void*>()(pointer) ^ std::hash<std::size_t>()(number);
      });
}

using IdentityKey = std::pair<const void*, std::size_t>;
inline IdentityKey KeyOf(const MapInAtlas& map) { return {map.atlas.get(), map.row}; }
template <auto List>
IdentityKey KeyOf(const EntitiesInMap<List>& entities) {
  return KeyOf(entities.of);
}
template <class Entity>
IdentityKey KeyOf(const Row<Entity>& row) {
  return {row.entity, 0};
}

template <class Class>
void DefineIdentity(Class& defined) {
  DefineIdentity(defined, [](const typename Class::type& value) { return KeyOf(value); });
}

// Rows one after the other, of the value as it was at the beginning.
template <class Entity>
struct RowIterator {
  std::shared_ptr<Column<Entity>> list;
  std::size_t next = 0;
};

// A mask of as many rows as there are; throws TypeError where it is none.
std::vector<std::size_t> RowsOfMask(const pybind11::object& index, std::size_t size);

// One row of a number; a list of them of a slice, or a mask.
template <class Entity>
pybind11::object RowsAt(const std::shared_ptr<Column<Entity>>& list, const pybind11::object& index) {
  pybind11::list rows;
  if (PySlice_Check(index.ptr())) {
    pybind11::ssize_t start = 0, stop = 0, step = 0, length = 0;
    const auto slice = pybind11::reinterpret_borrow<pybind11::slice>(index);
    if (!slice.compute(static_cast<pybind11::ssize_t>(list->size()), &start, &stop, &step, &length))
      throw pybind11::error_already_set();
    for (; length > 0; --length, start += step) rows.append(RowOf(list, start));
    return rows;
  }
  if (PyIndex_Check(index.ptr()) && !pybind11::hasattr(index, "__len__")) {
    const pybind11::ssize_t row = PyNumber_AsSsize_t(index.ptr(), PyExc_IndexError);
    if (row == -1 && PyErr_Occurred() != nullptr) throw pybind11::error_already_set();
    return pybind11::cast(RowOf(list, row));
  }
  for (const std::size_t row : RowsOfMask(index, list->size()))
    rows.append(RowOf(list, static_cast<pybind11::ssize_t>(row)));
  return rows;
}

inline std::string Counted(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

// len(), [], iteration, equality and repr of the list of a map.
template <class Class>
void DefineContainer(Class& entities, const char* noun) {
  using Entities = typename Class::type;
  entities.def("__len__", [](const Entities& e) { return e.list()->size(); })
      .def("__repr__",
           [noun, name = pybind11::str(entities.attr("__name__")).template cast<std::string>()](const Entities& e) {
             return "<slamdb." + name + ": " + Counted(e.list()->size(), noun) + " of " + ToString(e.of.id) + ">";
           });
  DefineIdentity(entities);
}

template <class Entity, class Class>
void DefineRowContainer(pybind11::module_& module, Class& entities, const char* noun, const char* iterator) {
  using Entities = typename Class::type;
  using Iterator = RowIterator<Entity>;
  DefineContainer(entities, noun);
  entities
      .def(
          "__getitem__", [](const Entities& e, const pybind11::object& index) { return RowsAt(e.list(), index); },
          pybind11::arg("rows"), "One row of a number; a list of rows of a slice, or a mask (N,) bool.")
      .def("__iter__", [](const Entities& e) { return Iterator{e.list()}; });
  pybind11::class_<Iterator>(module, iterator)
      .def("__iter__", [](const pybind11::object& self) { return self; })
      .def("__next__", [](Iterator& it) {
        if (it.next >= it.list->size()) throw pybind11::stop_iteration();
        return RowOf(it.list, static_cast<pybind11::ssize_t>(it.next++));
      });
}

}  // namespace slamdb::python
