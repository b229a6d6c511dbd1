// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/module.h"

#include "python/src/errors.h"
#include "slamdb/model/ids.h"
#include "slamdb/version.h"

PYBIND11_MODULE(_slamdb, module) {
  module.doc() = "The part of slamdb's Python package that is in C++.";
  slamdb::python::TranslateErrors();
  slamdb::python::DefineKeyFrames(module);
  slamdb::python::DefinePoints(module);
  slamdb::python::DefineAtlas(module);
  slamdb::python::DefineFiles(module);
  slamdb::python::DefineStore(module);
  slamdb::python::DefineMany(module);
  slamdb::python::DefineVerbs(module);
  module.attr("NONE") = slamdb::MapId::kNone;
  module.attr("version") = std::string(slamdb::Version());
}
