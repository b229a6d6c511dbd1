// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/arrays.h"

#include <utility>

namespace slamdb::python {

namespace py = pybind11;

py::array ViewOf(const Kept& kept, const py::dtype& type, ArrayPlace place) {
  if (place.shape.front() == 0) return py::array(type, std::move(place.shape));
  const py::capsule keeper(new Kept(kept), [](void* held) { delete static_cast<Kept*>(held); });
  return py::array(type, std::move(place.shape), std::move(place.strides), place.data, keeper);
}

py::array ReadOnly(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace slamdb::python
