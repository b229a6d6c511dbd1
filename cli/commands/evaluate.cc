// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/evaluate.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/options.h"
#include "cli/reference.h"
#include "cli/report/evaluate_text.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/limits.h"

namespace slamdb::cli {
namespace {

struct EvaluateVerbOptions {
  std::string estimate, reference, layout;
  std::vector<std::uint64_t> maps;
  std::optional<std::uint64_t> reference_map;
  bool body = false, json = false, with_errors = false;
  TimesOptions times;
  std::vector<std::string> deltas;
  EvaluationOptions evaluation;
  EvaluationLimits limits;
  std::string output, aligned;
  bool overwrite = false;
  double wait = kUsualWait;
};

EvaluationReport Evaluate(const EvaluateVerbOptions& options, Console& console, Notices& notices) {
  TrajectoriesOptions read{.body = options.body, .wait = options.wait};
  TrajectoriesOptions read_truth = read;
  read.layout = options.layout;
  read_truth.times = options.times;
  Estimates estimate = ReadTrajectoriesOf(options.estimate, read, console, notices);
  Estimates truth = ReadTrajectoriesOf(options.reference, read_truth, console, notices);
  RefuseIdleBody(estimate, truth, options.body);
  TellWhosePoses(estimate, truth, options.body, notices);
  KeepMaps(estimate, options.maps);
  if (truth.list.size() > 1 && !options.reference_map)
    throw Error(ErrorKind::kNotPossible, options.reference, "",
                detail::Concat("must hold one trajectory, not ", truth.list.size(), "; --reference-map chooses one"));
  const Estimate reference = TakeOnly(std::move(truth), options.reference_map);
  EvaluationOptions evaluation = options.evaluation;
  evaluation.threads = console.threads();
  evaluation.progress = console.MakeProgress();
  return EvaluateEstimates(std::move(estimate), reference, evaluation);
}

// Opened before the work, so that what would fail at the end fails at once.
class OutputFile {
 public:
  OutputFile(const std::string& path, bool overwrite) : is_standard_(!path.empty() && IsStandardOutput(path)) {
    if (!path.empty() && !is_standard_) file_.emplace(path, AtomicFileOptions{.overwrite = overwrite});
  }
  bool wanted() const { return is_standard_ || file_.has_value(); }
  bool is_standard() const { return is_standard_; }

  void Write(const std::string& text, Console& console) {
    if (is_standard_) console.PrintData(text);
    if (!file_) return;
    file_->Write(text);
    file_->Commit();
  }

 private:
  bool is_standard_;
  std::optional<AtomicFile> file_;
};

std::string ReportText(const EvaluationReport& report, const std::vector<std::string>& breaches,
                       const EvaluateVerbOptions& options, const Console& console) {
  if (!options.json) return EvaluateText(report, console.verbose());
  return ToJson(report, {.input = options.estimate,
                         .reference = options.reference,
                         .breaches = breaches,
                         .with_errors = options.with_errors});
}

ExitCode RunEvaluate(EvaluateVerbOptions options, Console& console) {
  if (options.with_errors && !options.json) RefuseUsage("--errors is for --json only; --output writes them as CSV");
  if (!options.deltas.empty()) options.evaluation.deltas.clear();
  for (const std::string& delta : options.deltas) options.evaluation.deltas.push_back(ParseDelta(delta));
  OutputFile output(options.output, options.overwrite), aligned(options.aligned, options.overwrite);
  Notices notices;
  const EvaluationReport report = Evaluate(options, console, notices);
  const std::vector<std::string> breaches = BreachesOf(report, options.limits);
  TellWarnings(report, notices);
  if (output.wanted()) output.Write(ErrorTable(report), console);
  if (aligned.wanted()) aligned.Write(AlignedTrajectory(report), console);
  console.Report(notices);
  PrintReport(ReportText(report, breaches, options, console), options.json,
              output.is_standard() || aligned.is_standard(), console);
  for (const std::string& breach : breaches) console.Fail(breach);
  return breaches.empty() ? ExitCode::kDone : ExitCode::kFailed;
}

std::string CheckDelta(const std::string& text) {
  try {
    (void)ParseDelta(text);
    return {};
  } catch (const Error& error) {
    return error.problem();
  }
}

void BindErrors(CLI::App& verb, EvaluateVerbOptions& options) {
  constexpr const char* kGroup = "Errors";
  EvaluationOptions& evaluation = options.evaluation;
  AddAlignment(verb, evaluation, kGroup);
  verb.add_option("--align-first", evaluation.align_first, "Align by the first so many pairs only")
      ->type_name("N")
      ->group(kGroup);
  verb.add_option("--delta", options.deltas,
                  "Relative errors over this distance: 1m, 2s, 10f (frames), 90deg; may be given several times; by "
                  "default 1f, 1m and 1s")
      ->type_name("DELTA")
      ->check(CheckDelta)
      ->allow_extra_args(false)
      ->group(kGroup);
  verb.add_option("--delta-tolerance", evaluation.delta_tolerance,
                  "Share of the delta that the distance may be off, for seconds and all pairs")
      ->type_name("SHARE")
      ->check(Within(kNonNegative))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_flag("--all-pairs", evaluation.all_pairs, "Relative errors from every pose, not one behind the other")
      ->group(kGroup);
  verb.add_flag("--pairs-from-reference", evaluation.pairs_from_reference,
                "Distances of relative errors are those of the truth")
      ->group(kGroup);
}

void BindLimits(CLI::App& verb, EvaluationLimits& limits) {
  constexpr const char* kGroup = "Limits, for CI; exit status 1 when one is broken";
  const auto add = [&](const char* name, std::optional<double>& limit, const char* help, const char* type) {
    verb.add_option(name, limit, help)->type_name(type)->check(Within(kNonNegative))->group(kGroup);
  };
  add("--max-ate-rmse", limits.max_ate_rmse, "Absolute error of positions, root mean square", "METRES");
  add("--max-ate", limits.max_ate, "The largest absolute error of a position", "METRES");
  add("--max-rotation-rmse", limits.max_rotation_rmse, "Absolute error of rotations, root mean square", "DEGREES");
  add("--max-rpe-rmse", limits.max_rpe_rmse, "Relative error of positions over every delta, root mean square",
      "METRES");
  add("--min-paired", limits.min_paired, "Share of the estimate's poses that are paired", "PERCENT");
  add("--min-coverage", limits.min_coverage, "Share of the truth's time that is covered", "PERCENT");
}

Run AddEvaluate(CLI::App& verb) {
  const auto options = std::make_shared<EvaluateVerbOptions>();
  verb.add_option(
          "ESTIMATE", options->estimate,
          "What is evaluated: an atlas, a trajectory (TUM, EuRoC, KITTI, tables of ROS), or - for standard input")
      ->type_name("FILE")
      ->required();
  verb.add_option("TRUTH", options->reference, "What it is held against: a trajectory, or another atlas")
      ->type_name("FILE")
      ->required();
  verb.add_option("--map", options->maps, "Evaluate only the map of this id; may be given several times")
      ->type_name("ID")
      ->allow_extra_args(false);
  verb.add_option("--reference-map", options->reference_map, "The map of the truth, where it is an atlas of several")
      ->type_name("ID");
  verb.add_flag("--joint", options->evaluation.joint,
                "All maps are in one frame, and aligned and measured as one; by default each is by itself");
  verb.add_flag("--body", options->body, "Poses of atlases are those of the IMU, not of the camera");
  AddLayout(verb, options->layout);
  AddPairing(verb, options->evaluation, options->times, "Pairs");
  BindErrors(verb, *options);
  BindLimits(verb, options->limits);
  Mark(verb.add_option("-o,--output", options->output, "Write the errors of every pose to this file, as CSV"),
       Writes::kFile)
      ->type_name("FILE");
  Mark(verb.add_option("--aligned", options->aligned, "Write the aligned estimate to this file, as a TUM trajectory"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace the output files if they are there");
  AddJson(verb, options->json);
  verb.add_flag("--errors", options->with_errors, "The JSON has the errors of every pose, too");
  AddWait(verb, options->wait);
  return [options](Console& console) { return RunEvaluate(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb evaluate lab.osa lab.txt", "Absolute and relative errors of every map."},
    {"slamdb evaluate mono.osa ground_truth.txt --max-ate-rmse 0.05 --min-coverage 90",
     "In CI: exit status 1 when the map is worse. The scale, which a lone camera leaves open, is solved for."},
    {"slamdb evaluate lab.txt lab.osa --align none --delta 1f --all-pairs --json",
     "A trajectory against the map of a longer run, as it stands."},
    {"slamdb evaluate lab.osa lab.txt -o errors.csv --aligned aligned.txt", "For plots of one's own."},
};

}  // namespace

const Command kEvaluate = {
    .name = "evaluate",
    .summary = "tell how far trajectories and maps are from the truth",
    .group = Group::kLook,
    .description =
        R"(Pairs the keyframes of each map, or the poses of a trajectory, with the truth by time, lays them onto it, and measures
what is left: absolute errors (ATE) of positions and rotations, relative errors (RPE) of the motion over a distance, and how much of the
truth is covered. Figures are defined as evo's, and equal to them.

An atlas counts by its keyframes that are not flagged bad. Each map has a frame of its own, and so is aligned and measured by
itself; --joint takes all maps as one, for maps that were brought into one frame. -v tells more statistics.

`slamdb transform --onto` moves a map there for good.)",
    .done = "Done; no limit is broken.",
    .failed = "An input could not be read, no map could be evaluated, an output not be written, or a limit is broken.",
    .examples = kExamples,
    .add = AddEvaluate,
};

}  // namespace slamdb::cli
