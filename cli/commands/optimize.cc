// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/optimize.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/libraries.h"
#include "cli/report/optimize_text.h"
#include "cli/values.h"
#include "slamdb/base/error.h"
#include "slamdb/optimize/warnings.h"

namespace slamdb::cli {
namespace {

struct OptimizeVerbOptions {
  EditOptions edit;
  OptimizeOptions optimize;
  std::optional<OptimizeMethod> method;
  std::vector<std::uint64_t> maps;
  std::string constraints;
};

ExitCode RunOptimize(const OptimizeVerbOptions& options, Console& console) {
  GoOnWithLibraries();
  Notices notices;
  OptimizeOptions optimize = options.optimize;
  for (const std::uint64_t id : options.maps) optimize.maps.emplace_back(id);
  if (!options.constraints.empty()) optimize.constraints = ReadConstraints(options.constraints, &notices);
  optimize.method = options.method.value_or(UsualMethod(optimize.constraints));
  if (optimize.method == OptimizeMethod::kPoseGraph) {
    if (optimize.constraints.empty()) RefuseUsage("--method pose-graph needs --constraints with a row");
    if (optimize.fix_poses || optimize.fix_points)
      RefuseUsage("--fix-poses and --fix-points are of bundle adjustment: --method full or seam");
  }
  optimize.threads = console.threads();
  optimize.progress = console.MakeProgress();
  Atlas atlas = ReadInput(options.edit, console, notices);
  const OptimizeReport report = NamingFile(options.edit.input, [&] {
    OptimizeReport done = OptimizeMaps(atlas, optimize);
    RequireOptimized(done);
    return done;
  });
  for (const MapOptimization& map : report.maps)
    TellWarnings(map, "OptimizeOptions::iterations allows more steps", notices);
  WriteResult(atlas, options.edit, "optimize " + options.edit.input, console, notices);
  return FinishEdit(OptimizeText(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

Run AddOptimize(CLI::App& verb) {
  const auto options = std::make_shared<OptimizeVerbOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  OptimizeOptions& optimize = options->optimize;
  verb.add_option("--method", options->method,
                  "Bundle adjustment of everything (full, the default) or of the keyframes around merge and loop edges "
                  "(seam), or the constraints alone (pose-graph, the default where there are some)")
      ->type_name("METHOD")
      ->transform(OneOf(kOptimizeMethods));
  verb.add_option("--map", options->maps, "Optimise only the map of this id; may be given several times")
      ->type_name("ID")
      ->allow_extra_args(false);
  verb.add_option("--constraints", options->constraints,
                  "A table of how keyframes really lie to each other: first,second,tx,ty,tz,qx,qy,qz,qw[,scale]. The "
                  "map is bent to them first")
      ->type_name("FILE");
  verb.add_option("--iterations", optimize.iterations, "At most so many steps of each of the rounds; 50 by default")
      ->type_name("N")
      ->check(Within(kPositive));
  CLI::Option* poses = verb.add_flag("--fix-poses", optimize.fix_poses, "Move points only");
  verb.add_flag("--fix-points", optimize.fix_points, "Move keyframes only")->excludes(poses);
  return [options](Console& console) { return RunOptimize(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb optimize session.osa better.osa", "Full bundle adjustment; the report says what it did."},
    {"slamdb optimize session.osa --dry-run --json", "What it would do, for programs."},
    {"slamdb optimize merged.osa tight.osa --method seam", "Tightens what was merged, and leaves the rest as it is."},
    {"slamdb optimize session.osa closed.osa --constraints loops.csv",
     "Bends the map to loops that were found elsewhere."},
};

}  // namespace

const Command kOptimize = {
    .name = "optimize",
    .summary = "bundle adjustment of maps, offline, with a report",
    .group = Group::kChange,
    .description =
        R"(Moves keyframes and points to where the observations fit best, as the global bundle adjustment of ORB-SLAM3 does:
monocular, rectified stereo, depth and fisheye pairs, with the same robust limits, and what the IMU measured where a map
is inertial. Observations that do not fit are dropped, and points that are left with too few. The initial keyframe stays
where it is, and so does the scale of a map that has none of its own.

--constraints bends the map along its essential graph, so that keyframes lie to each other as the table says: for loops
that SLAM missed. Bundle adjustment behind that holds a loop closed only where both ends see the same points.
docs/optimize.md says what is moved, and how.)",
    .failed =
        "The input could not be read, nothing can be optimised in it, this slamdb was built without Ceres, or the "
        "output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddOptimize,
};

}  // namespace slamdb::cli
