// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/memory.h"

#include <utility>

#include "python/src/arguments.h"
#include "python/src/module.h"

// How much memory is taken. slamdb/memory.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

void DefineMemory(py::module_& module) {
  module.def("set_memory_limit", [](py::dict values) {
    Arguments given(std::move(values));
    MemoryLimit limit;
    given.Take("memory", limit.bytes, cli::kMemory);
    if (given.Has("spill")) limit.spill_folder = given.Path("spill");
    SetMemoryLimit(limit);
  });
  module.def("spilled", [] { return SpilledNow().bytes; });
}

}  // namespace slamdb::python
