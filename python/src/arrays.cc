// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/arrays.h"

#include <atomic>
#include <mutex>
#include <utility>

#include "python/src/unlocked.h"

namespace slamdb::python {

namespace py = pybind11;

void RequireNumpy() {
  static std::atomic<bool> is_there = false;
  if (is_there) return;
  static std::mutex first;
  std::unique_lock lock(first, std::defer_lock);
  {
    const Unlocked unlocked;
    lock.lock();
  }
  py::detail::npy_api::get();
  is_there = true;
}

py::array ArrayOrNull(py::handle object) {
  RequireNumpy();
  py::array array = py::array::ensure(object);
  if (!array) PyErr_Clear();
  return array;
}

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
