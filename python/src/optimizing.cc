// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/align/close_loops.h"
#include "slamdb/optimize/optimize.h"
#include "slamdb/optimize/warnings.h"

// Bundle adjustment and pose graphs. slamdb/optimizing.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

void DefineOptimize(py::module_& module) {
  DefineChange(module, "optimize", [](Arguments& given) {
    OptimizeOptions options;
    std::optional<OptimizeMethod> method;
    given.TakeWord("method", cli::kOptimizeMethods, method);
    given.TakeIds("map", options.maps);
    given.Take("iterations", options.iterations, cli::kPositive);
    given.Take("fix_poses", options.fix_poses);
    given.Take("fix_points", options.fix_points);
    given.TakeRun(options);
    return [options, method, table = given.Path("constraints")](Atlas& atlas, Notices& notices) {
      OptimizeOptions optimize = options;
      if (!table.empty()) optimize.constraints = ReadConstraints(table, &notices);
      optimize.method = method.value_or(UsualMethod(optimize.constraints));
      const OptimizeReport report = OptimizeMaps(atlas, optimize);
      RequireOptimized(report);
      for (const MapOptimization& map : report.maps)
        TellWarnings(map, "OptimizeOptions::iterations allows more steps", notices);
      return ToJson(report);
    };
  });
}

void DefineCloseLoops(py::module_& module) {
  DefineChange(module, "close_loops", [](Arguments& given) {
    CloseLoopsOptions options;
    given.TakeWord("optimize", cli::kLoopOptimizations, options.adjust_bundle);
    given.TakeIds("map", options.maps);
    given.Take("own_vocabulary", options.own_vocabulary);
    given.TakeRun(options);
    return [options](Atlas& atlas, Notices& notices) {
      const CloseLoopsReport report = CloseLoops(atlas, options);
      for (const ClosedMap& map : report.maps) TellWarnings(map.optimization, "`OptimizeMaps` goes on", notices);
      return ToJson(report);
    };
  });
}

}  // namespace

void DefineOptimizing(py::module_& module) {
  DefineOptimize(module);
  DefineCloseLoops(module);
}

}  // namespace slamdb::python
