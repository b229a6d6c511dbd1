// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/errors.h"
#include "python/src/held_atlas.h"
#include "python/src/module.h"
#include "slamdb/checks/report.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/location.h"
#include "slamdb/formats/salvage.h"

// The verbs, each of which gives its report as JSON. slamdb/verbs.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using Held = std::shared_ptr<HeldAtlas>;
using Texts = std::vector<std::string>;

void DefineCheck(py::module_& module) {
  module.def("check", [](const HeldAtlas& atlas, const std::string& name, const Texts& ignore, const Texts& note,
                         const Texts& warn, const Texts& error, bool strict, std::size_t max_findings,
                         const std::map<std::string, double>& gates, int threads, const py::object& progress) {
    CheckOptions options{.ignore = ignore,
                         .note = note,
                         .warn = warn,
                         .error = error,
                         .strict = strict,
                         .max_findings = max_findings,
                         .threads = threads,
                         .progress = ProgressTo(progress)};
    for (const auto& [gate, limit] : gates) options.gates.push_back({gate, limit});
    const auto value = atlas.value();
    const py::gil_scoped_release unlocked;
    CheckedFile checked{.name = name};
    checked.report = CheckAtlas(*value, options);
    return ToJson(std::span<const CheckedFile>(&checked, 1));
  });
}

void DefineRepair(py::module_& module) {
  module.def("repair", [](HeldAtlas& atlas, const Texts& rules, int threads, const py::object& progress) {
    const RepairOptions options{.rules = rules, .threads = threads, .progress = ProgressTo(progress)};
    return atlas.Apply([&](Atlas& changed) { return ToJson(RepairAtlas(changed, options)); });
  });
  module.def("recover", [](const std::string& path, const std::string& format, bool triangulate, int threads,
                           const py::object& progress) {
    const ReadOptions reading{.format = format, .threads = threads, .progress = ProgressTo(progress)};
    const RecoverOptions options{.triangulate = triangulate, .threads = threads, .progress = ProgressTo(progress)};
    Salvage salvage;
    const std::string report = [&] {
      const py::gil_scoped_release unlocked;
      salvage = SalvageAtlas(Location(path), reading);
      return ToJson(RecoverSalvage(salvage, options), {.input = path});
    }();
    return py::make_tuple(std::make_shared<HeldAtlas>(std::move(salvage.atlas)), report);
  });
}

void DefineCompare(py::module_& module) {
  module.def("diff",
             [](const HeldAtlas& before, const HeldAtlas& after, const std::pair<std::string, std::string>& names,
                double tolerance, int threads, const py::object& progress) {
               const DiffOptions options{.tolerance = tolerance, .threads = threads, .progress = ProgressTo(progress)};
               const auto one = before.value(), other = after.value();
               const py::gil_scoped_release unlocked;
               return ToJson(DiffAtlases(*one, *other, options), {.before = names.first, .after = names.second});
             });
}

SameMap SameMapOf(const std::string& name) {
  if (name == "keep-both") return SameMap::kKeepBoth;
  if (name == "error") return SameMap::kError;
  if (name == "keep-first") return SameMap::kKeepFirst;
  throw py::value_error("same_map is 'keep-both', 'keep-first' or 'error'");
}

void DefineMerge(py::module_& module) {
  module.def("merge", [](const std::vector<Held>& inputs, const Texts& names, const std::string& same_map,
                         bool ignore_vocabulary, int threads, const py::object& progress) {
    const MergeOptions options{.names = names,
                               .same_map = SameMapOf(same_map),
                               .ignore_vocabulary = ignore_vocabulary,
                               .threads = threads,
                               .progress = ProgressTo(progress)};
    std::vector<std::shared_ptr<Atlas>> values;
    for (const Held& input : inputs) values.push_back(input->value());
    MergeResult result = [&] {
      const py::gil_scoped_release unlocked;
      std::vector<Atlas> copies;
      for (const auto& value : values) copies.push_back(*value);
      return MergeAtlases(std::move(copies), options);
    }();
    return py::make_tuple(std::make_shared<HeldAtlas>(std::move(result.atlas)), ToJson(result.report));
  });
}

}  // namespace

void DefineVerbs(py::module_& module) {
  DefineCheck(module);
  DefineRepair(module);
  DefineCompare(module);
  DefineMerge(module);
}

}  // namespace slamdb::python
