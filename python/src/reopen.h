// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace slamdb::python {

// A class that another file has defined, to add to: `Class` is the py::class_ that it was defined with.
template <class Class>
Class Reopen(const pybind11::module_& module, const char* name) {
  return pybind11::reinterpret_borrow<Class>(module.attr(name));
}

}  // namespace slamdb::python
