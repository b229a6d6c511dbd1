// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/landmarks/warnings.h"

// Landmarks of MRPT. slamdb/landmarks.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

void DefineFromPoints(py::module_& module) {
  DefineChange(module, "landmarks_from_points", [](Arguments& given) {
    MakeLandmarksOptions options;
    given.Take("sigma", options.pixel_sigma, cli::kPixelSigma);
    given.TakeRun(options);
    return [options](Atlas& atlas, Notices&) {
      const MakeLandmarksReport report = MakeLandmarks(atlas, options);
      RequireMade(report);
      return ToJson(report);
    };
  });
}

void DefineToPoints(py::module_& module) {
  DefineChange(module, "landmarks_to_points", [](Arguments&) {
    return [](Atlas& atlas, Notices& notices) {
      RequireLandmarks(atlas);
      const MakePointsReport report = MakePoints(atlas);
      WarnOfUnobserved(report.added, notices);
      TellWarnings(report, notices);
      return ToJson(report);
    };
  });
}

// Onto the atlas that they were made of.
void DefineLay(py::module_& module) {
  DefineChange(module, "lay_landmarks", [](Arguments& given) {
    LayLandmarksOptions options;
    given.Take("add", options.add);
    return [options, source = given.SourceAt("landmarks")](Atlas& atlas, Notices& notices) {
      const auto landmarks = Hold(source, {}, notices);
      RequireLandmarks(*landmarks);
      const LayLandmarksReport report = LayLandmarks(atlas, *landmarks, options);
      WarnOfUnobserved(report.added, notices);
      TellWarnings(report, "the atlas", notices);
      return ToJson(report, {}, source.path);
    };
  });
}

}  // namespace

void DefineLandmarkVerbs(py::module_& module) {
  DefineFromPoints(module);
  DefineToPoints(module);
  DefineLay(module);
}

}  // namespace slamdb::python
