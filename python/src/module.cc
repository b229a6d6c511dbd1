// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/module.h"

#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/words.h"
#include "python/src/errors.h"
#include "slamdb/model/ids.h"
#include "slamdb/version.h"

namespace {

namespace py = pybind11;

PyObject* NewInstance(PyTypeObject* type, PyObject*, PyObject*) { return py::detail::make_new_instance(type); }

// Objects hold something from __init__ on, or from where C++ makes them. `Points.__new__(Points)`, of the base of all
// classes, would give one that holds nothing; Python refuses it for classes that have a __new__ of their own.
void RefuseBareInstances(const py::module_& module) {
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(module.attr("__dict__"))) {
    auto* type = reinterpret_cast<PyTypeObject*>(value.ptr());
    if (PyType_Check(value.ptr()) != 0 && py::detail::get_type_info(type) != nullptr) type->tp_new = &NewInstance;
  }
}

}  // namespace

PYBIND11_MODULE(_slamdb, module) {
  module.doc() = "The part of slamdb's Python package that is in C++.";
  slamdb::python::TranslateErrors();
  slamdb::python::DefineKeyFrames(module);
  slamdb::python::DefinePoints(module);
  slamdb::python::DefineAtlas(module);
  slamdb::python::DefineFiles(module);
  slamdb::python::DefineMany(module);
  slamdb::python::DefineMemory(module);
  slamdb::python::DefineStore(module);
  slamdb::python::DefineVerbs(module);
  slamdb::python::DefineRows(module);
  slamdb::python::DefineColumns(module);
  slamdb::python::DefineGraphs(module);
  slamdb::python::DefineLandmarks(module);
  slamdb::python::DefineBuilding(module);
  slamdb::python::DefineMapVerbs(module);
  slamdb::python::DefineEditing(module);
  slamdb::python::DefinePickling(module);
  slamdb::python::DefineNotebook(module);
  slamdb::python::DefineParts(module);
  slamdb::python::DefineIds(module);
  slamdb::python::DefineFrames(module);
  slamdb::python::DefineOptimizing(module);
  slamdb::python::DefineLandmarkVerbs(module);
  slamdb::python::DefineVocabulary(module);
  slamdb::python::DefineAligning(module);
  slamdb::python::DefineEstimates(module);
  slamdb::python::DefineOutputs(module);
  slamdb::python::DefineLayouts(module);
  RefuseBareInstances(module);
  module.attr("NONE") = slamdb::MapId::kNone;
  module.def("command_words", [] {
    std::vector<std::pair<std::string, std::string>> words;
    for (const slamdb::cli::Word& word : slamdb::cli::Words()) words.emplace_back(word.library, word.command);
    return words;
  });
  module.attr("version") = std::string(slamdb::Version());
}
