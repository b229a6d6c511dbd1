// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/close_loops.h"

#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/libraries.h"
#include "cli/report/close_loops_text.h"
#include "cli/report/optimize_text.h"
#include "slamdb/optimize/warnings.h"

namespace slamdb::cli {
namespace {

struct CloseLoopsVerbOptions {
  EditOptions edit;
  CloseLoopsOptions close;
  std::vector<std::uint64_t> maps;
};

ExitCode RunCloseLoops(const CloseLoopsVerbOptions& options, Console& console) {
  GoOnWithLibraries();
  Notices notices;
  CloseLoopsOptions close = options.close;
  for (const std::uint64_t id : options.maps) close.maps.emplace_back(id);
  close.threads = console.threads();
  close.progress = console.MakeProgress();
  Atlas atlas = ReadInput(options.edit, console, notices);
  const CloseLoopsReport report = NamingFile(options.edit.input, [&] { return CloseLoops(atlas, close); });
  for (const ClosedMap& map : report.maps) TellWarnings(map.optimization, "`OptimizeMaps` goes on", notices);
  WriteResult(atlas, options.edit, "close-loops " + options.edit.input, console, notices);
  return FinishEdit(CloseLoopsText(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

Run AddCloseLoops(CLI::App& verb) {
  const auto options = std::make_shared<CloseLoopsVerbOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  verb.add_option(
          "--optimize", options->close.adjust_bundle,
          "Behind the pose graph, which closes them: bundle adjustment of the whole map (full, the default), or "
          "nothing more (pose-graph)")
      ->type_name("METHOD")
      ->transform(OneOf(kLoopOptimizations));
  verb.add_option("--map", options->maps, "Close loops only in the map of this id; may be given several times")
      ->type_name("ID")
      ->allow_extra_args(false);
  verb.add_flag("--own-vocabulary", options->close.own_vocabulary,
                "Recognise places by a vocabulary that is trained on the map, not by the recorded words");
  return [options](Console& console) { return RunCloseLoops(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb close-loops session.osa closed.osa", "Closes what SLAM missed, and says why it believes it."},
    {"slamdb close-loops session.osa --dry-run --json", "What is there to close, for programs."},
    {"slamdb close-loops session.osa closed.osa --optimize pose-graph", "Bends the map only: in less than a second."},
};

}  // namespace

const Command kCloseLoops = {
    .name = "close-loops",
    .summary = "find and close loops that SLAM missed",
    .group = Group::kChange,
    .description =
        R"(Finds places that a map is at twice and does not know, from what its file holds, and closes those that are sure: the map
is bent along its essential graph until both ends lie as their pictures say, points of both are fused, and all is adjusted.
Scale drifts too where a map is monocular, and is bent with the rest.

A loop counts only where several pairs of keyframes agree on it and the pictures about each end show what the other end
holds. What could be a look-alike is reported and left alone; a wrong loop is worse than none. A place that the map has
where the pictures do needs no closing. Without a loop to close the output is the input.)",
    .failed =
        "The input could not be read, this slamdb was built without Ceres and there is a loop to close, or the output "
        "could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddCloseLoops,
};

}  // namespace slamdb::cli
