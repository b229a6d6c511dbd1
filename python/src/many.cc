// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "python/src/errors.h"
#include "python/src/held_atlas.h"
#include "python/src/module.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/many/inputs.h"
#include "slamdb/many/list.h"

// Many atlases, and what is told of them. slamdb/many.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using Texts = std::vector<std::string>;

AtlasInputs Found(const Texts& names, bool recursive, double lock_timeout, py::handle progress) {
  const FindAtlasesOptions options{
      .recursive = recursive, .lock_timeout = lock_timeout, .progress = ProgressTo(progress)};
  const py::gil_scoped_release unlocked;
  return FindAtlases(names, options);
}

void DefineInputs(py::module_& module) {
  module.def("find_atlases", [](const Texts& names, bool recursive, double lock_timeout, const py::object& progress) {
    const AtlasInputs found = Found(names, recursive, lock_timeout, progress);
    py::list atlases;
    for (const AtlasInput& atlas : found.atlases)
      atlases.append(py::make_tuple(TextOf(atlas.location.ToString()), TextOf(atlas.below), TextOf(atlas.failure)));
    return atlases;
  });
  module.def("list_atlases", [](const Texts& names, bool recursive, bool check, double lock_timeout, int threads,
                                const py::object& progress) {
    const AtlasInputs found = Found(names, recursive, lock_timeout, progress);
    ListOptions options{.lock_timeout = lock_timeout, .threads = threads, .progress = ProgressTo(progress)};
    if (check) options.check.emplace();
    const py::gil_scoped_release unlocked;
    return ToJson(ListAtlases(found, options), names.size() == 1 ? names.front() : std::string());
  });
}

}  // namespace

void DefineMany(py::module_& module) {
  DefineInputs(module);
  module.def("summarize", [](const HeldAtlas& atlas) {
    const auto value = atlas.value();
    const py::gil_scoped_release unlocked;
    return ToJson(Summarize(*value));
  });
  module.def("write_file", [](const std::string& path, const py::bytes& data, bool overwrite, bool sync) {
    const std::string_view held(data);  // by the caller's argument
    const py::gil_scoped_release unlocked;
    AtomicFile file(path, {.overwrite = overwrite, .sync = sync});
    file.Write(held);
    file.Commit();
  });
}

}  // namespace slamdb::python
