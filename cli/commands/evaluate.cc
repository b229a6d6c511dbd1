// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/evaluate.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/evaluate_text.h"
#include "cli/report/layout.h"
#include "cli/times.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/evaluate/limits.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/statistics.h"

namespace slamdb::cli {
namespace {

struct EvaluateVerbOptions {
  std::string estimate, reference;
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

// A file with trajectories, or an atlas.
struct Input {
  std::vector<Estimate> trajectories;
  const Format* format = nullptr;
  bool has_imu = false;
};

Input ReadAnAtlas(const HeldSource& held, const ReadOptions& read, bool body, Notices& notices) {
  Input input;
  const Atlas atlas = ReadAtlas(held, read, &notices);
  for (MapTrajectory& trajectory : TrajectoriesOf(atlas, body ? PoseFrame::kBody : PoseFrame::kCamera, &notices)) {
    const Map& map = *std::ranges::find(atlas.maps, trajectory.map, &Map::id);
    input.has_imu |= std::ranges::any_of(
        map.keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.imu_calibration.is_set}; });
    input.trajectories.push_back({.map = map.id, .poses = std::move(trajectory.poses), .open_scale = !IsMetric(map)});
  }
  if (body && !input.has_imu)
    throw Error(ErrorKind::kNotPossible, held.source().path, "",
                "has no IMU calibration, so that nobody knows where its body is");
  return input;
}

Input ReadInput(const std::string& path, const TimesOptions& times, const EvaluateVerbOptions& options,
                Console& console, Notices& notices) {
  ReadOptions read = MakeReadOptions(console, {}, options.wait);
  read.features = FeatureColumns::kGeometry;  // depths tell whether the scale is open
  read.of<TrajectoryReadOptions>() = times.ForReading();
  const HeldSource held = HoldInput(path, read);
  const Format* format = FindFormatOfInput(held);
  RefuseIdleTimes(format, times);
  Input input;
  if (format != nullptr && IsTrajectory(*format)) {
    for (MapTrajectory& trajectory : ReadTrajectories(held, read, &notices))
      input.trajectories.push_back({.map = trajectory.map, .poses = std::move(trajectory.poses)});
    if (input.trajectories.size() == 1) input.trajectories.front().map = MapId();
  } else {
    input = ReadAnAtlas(held, read, options.body, notices);
  }
  input.format = format;
  return input;
}

bool IsAtlas(const Input& input) { return input.format == nullptr || !IsTrajectory(*input.format); }

void KeepMaps(std::vector<Estimate>& trajectories, const std::vector<std::uint64_t>& maps, const std::string& path) {
  if (maps.empty()) return;
  for (const std::uint64_t map : maps)
    if (std::ranges::find(trajectories, MapId(map), &Estimate::map) == trajectories.end())
      throw Error(ErrorKind::kNotFound, path, "", detail::Concat("has no map ", map, " with a trajectory"));
  std::erase_if(trajectories, [&](const Estimate& trajectory) {
    return std::ranges::find(maps, trajectory.map.value()) == maps.end();
  });
}

std::vector<TrajectoryPose> TruthOf(Input& input, const EvaluateVerbOptions& options) {
  if (options.reference_map) KeepMaps(input.trajectories, {*options.reference_map}, options.reference);
  if (input.trajectories.size() != 1)
    throw Error(ErrorKind::kNotPossible, options.reference, "",
                detail::Concat("must hold one trajectory, not ", input.trajectories.size(),
                               input.trajectories.empty() ? "" : "; --reference-map chooses one"));
  return std::move(input.trajectories.front().poses);
}

EvaluationReport Evaluate(const EvaluateVerbOptions& options, Console& console, Notices& notices) {
  Input estimate = ReadInput(options.estimate, {}, options, console, notices);
  Input truth = ReadInput(options.reference, options.times, options, console, notices);
  if (options.body && !IsAtlas(estimate) && !IsAtlas(truth)) RefuseUsage("--body is for atlases only");
  if (!options.body && estimate.has_imu && !IsAtlas(truth))
    notices.Note(truth.format->id == "euroc" ? "the truth of EuRoC is that of the IMU, and the poses here are those of "
                                               "the camera; --body compares the IMU's"
                                             : "the poses here are those of the camera; where the truth is that of the "
                                               "IMU, --body compares the IMU's");
  KeepMaps(estimate.trajectories, options.maps, options.estimate);
  const std::vector<TrajectoryPose> reference = TruthOf(truth, options);
  EvaluationOptions evaluation = options.evaluation;
  evaluation.threads = console.threads();
  evaluation.progress = console.MakeProgress();
  return NamingFile(options.estimate,
                    [&] { return EvaluateTrajectories(std::move(estimate.trajectories), reference, evaluation); });
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

void TellWarnings(const EvaluationReport& report, Notices& notices) {
  for (const TrajectoryEvaluation& evaluation : report.evaluations) {
    const std::string maps = MapsText(evaluation);
    for (const std::string& warning : evaluation.warnings) notices.Warn((maps.empty() ? "" : maps + ": ") + warning);
  }
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

void BindPairing(CLI::App& verb, EvaluateVerbOptions& options) {
  constexpr const char* kGroup = "Pairs";
  EvaluationOptions& evaluation = options.evaluation;
  verb.add_option("--max-dt", evaluation.max_time_difference, "Seconds that the poses of a pair may be apart")
      ->type_name("SECONDS")
      ->check(CheckNonNegative)
      ->capture_default_str()
      ->group(kGroup);
  CLI::Option* offset = verb.add_option("--time-offset", evaluation.time_offset,
                                        "Seconds that the clock of the truth is ahead of the estimate's")
                            ->type_name("SECONDS")
                            ->check(CheckFinite)
                            ->group(kGroup);
  CLI::Option* estimate_offset = verb.add_flag("--estimate-time-offset", evaluation.estimate_time_offset,
                                               "Find the time offset under which speeds and paths agree best")
                                     ->excludes(offset)
                                     ->group(kGroup);
  verb.add_flag("--by-index", evaluation.by_index, "Pair the first pose with the first, whatever the times")
      ->excludes(offset)
      ->excludes(estimate_offset)
      ->group(kGroup);
  AddTimes(verb, options.times, "the truth", kGroup);
}

void BindErrors(CLI::App& verb, EvaluateVerbOptions& options) {
  constexpr const char* kGroup = "Errors";
  EvaluationOptions& evaluation = options.evaluation;
  verb.add_option(
          "--align", evaluation.alignment,
          "How the estimate is laid onto the truth: none, origin (first pose onto first), scale, se3 or sim3; by "
          "default sim3 for a map whose sensor leaves the scale open, and se3 else")
      ->type_name("HOW")
      ->transform(OneOf<AlignmentKind>({{"none", AlignmentKind::kNone},
                                        {"origin", AlignmentKind::kOrigin},
                                        {"scale", AlignmentKind::kScale},
                                        {"se3", AlignmentKind::kSe3},
                                        {"sim3", AlignmentKind::kSim3}}))
      ->group(kGroup);
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
      ->check(CheckNonNegative)
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
    verb.add_option(name, limit, help)->type_name(type)->check(CheckNonNegative)->group(kGroup);
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
  BindPairing(verb, *options);
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
