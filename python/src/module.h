// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

// What module.cc puts together: each defines what its file is about.
namespace slamdb::python {

void DefineAtlas(pybind11::module_& module);
void DefineKeyFrames(pybind11::module_& module);
void DefinePoints(pybind11::module_& module);
void DefineStore(pybind11::module_& module);
void DefineFiles(pybind11::module_& module);
void DefineNotebook(pybind11::module_& module);
void DefineMany(pybind11::module_& module);
void DefineMemory(pybind11::module_& module);
void DefineVerbs(pybind11::module_& module);
void DefineParts(pybind11::module_& module);
void DefineIds(pybind11::module_& module);
void DefineFrames(pybind11::module_& module);
void DefineOptimizing(pybind11::module_& module);
void DefineLandmarkVerbs(pybind11::module_& module);
void DefineVocabulary(pybind11::module_& module);
void DefineAligning(pybind11::module_& module);
void DefineEstimates(pybind11::module_& module);
void DefineOutputs(pybind11::module_& module);
void DefineLayouts(pybind11::module_& module);

// These add to the classes that the others have defined.
void DefineRows(pybind11::module_& module);
void DefineColumns(pybind11::module_& module);
void DefineGraphs(pybind11::module_& module);
void DefineLandmarks(pybind11::module_& module);
void DefineBuilding(pybind11::module_& module);
void DefineMapVerbs(pybind11::module_& module);
void DefineEditing(pybind11::module_& module);
void DefinePickling(pybind11::module_& module);

}  // namespace slamdb::python
