// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/estimates.h"

#include "cli/choices.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/evaluate/limits.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/orbslam3/options.h"

namespace slamdb::python {

TrajectoryReadOptions TimesOf(Arguments& given) {
  TrajectoryReadOptions times;
  given.TakeWord("time_unit", cli::kTimeUnits, times.time_unit);
  times.times = given.Path("times");
  return times;
}

Estimates EstimatesOf(const AtlasOrPath& source, const EstimatesOptions& options, Notices& notices) {
  if (source.atlas) return slamdb::EstimatesOf(*source.atlas, "", nullptr, options.body, notices);
  return ReadEstimates(HoldInput(Location(source.path), options.read), options, notices);
}

void TakeEvaluation(Arguments& given, EvaluationOptions& options) {
  given.Take("max_dt", options.max_time_difference, cli::kNonNegative);
  given.Take("time_offset", options.time_offset, cli::kFinite);
  given.Take("estimate_time_offset", options.estimate_time_offset);
  given.Take("by_index", options.by_index);
  given.TakeWord("align", cli::kAlignments, options.alignment);
  given.Take("joint", options.joint);
  given.TakeRun(options);
}

namespace {

struct Evaluating {
  AtlasOrPath estimate, truth;
  EstimatesOptions read_estimate, read_truth;
  EvaluationOptions options;
  EvaluationLimits limits;
  std::vector<std::uint64_t> maps;
  std::optional<std::uint64_t> reference_map;
  OutputFile output, aligned;
  bool errors = false;

  std::string Do(Notices& notices) const {
    Estimates own = EstimatesOf(estimate, read_estimate, notices);
    Estimates reference = EstimatesOf(truth, read_truth, notices);
    TellWhosePoses(own, reference, read_estimate.body, notices);
    KeepMaps(own, maps);
    const EvaluationReport report =
        EvaluateEstimates(std::move(own), TakeOnly(std::move(reference), reference_map), options);
    TellWarnings(report, notices);
    if (output.any()) output.Write(ErrorTable(report));
    if (aligned.any()) aligned.Write(AlignedTrajectory(report));
    return ToJson(report, {.input = estimate.path,
                           .reference = truth.path,
                           .breaches = BreachesOf(report, limits),
                           .with_errors = errors});
  }
};

EvaluationLimits LimitsOf(Arguments& given) {
  EvaluationLimits limits;
  given.Take("max_ate_rmse", limits.max_ate_rmse, cli::kNonNegative);
  given.Take("max_ate", limits.max_ate, cli::kNonNegative);
  given.Take("max_rotation_rmse", limits.max_rotation_rmse, cli::kNonNegative);
  given.Take("max_rpe_rmse", limits.max_rpe_rmse, cli::kNonNegative);
  given.Take("min_paired", limits.min_paired, cli::kNonNegative);
  given.Take("min_coverage", limits.min_coverage, cli::kNonNegative);
  return limits;
}

EvaluationOptions OptionsOf(Arguments& given) {
  EvaluationOptions options;
  TakeEvaluation(given, options);
  given.Take("align_first", options.align_first);
  if (given.Has("delta")) {
    options.deltas.clear();
    for (const std::string& delta : given.Get<std::vector<std::string>>("delta"))
      options.deltas.push_back(ParseDelta(delta));
  }
  given.Take("delta_tolerance", options.delta_tolerance, cli::kNonNegative);
  given.Take("all_pairs", options.all_pairs);
  given.Take("pairs_from_reference", options.pairs_from_reference);
  return options;
}

}  // namespace

void DefineEstimates(pybind11::module_& module) {
  DefineReport(module, "evaluate", [](Arguments& given) {
    Evaluating evaluating{.estimate = given.SourceAt("estimate"),
                          .truth = given.SourceAt("truth"),
                          .options = OptionsOf(given),
                          .limits = LimitsOf(given)};
    evaluating.read_estimate.body = evaluating.read_truth.body = given.Get<bool>("body");
    evaluating.read_estimate.read.of<Orbslam3ReadOptions>().layout = LayoutNamed(given.Path("layout"));
    evaluating.read_truth.read.of<TrajectoryReadOptions>() = TimesOf(given);
    evaluating.maps = given.Numbers("map");
    given.Take("reference_map", evaluating.reference_map);
    evaluating.output = given.Output("output");
    evaluating.aligned = given.Output("aligned");
    given.Take("errors", evaluating.errors);
    return [evaluating](Notices& notices) { return evaluating.Do(notices); };
  });
}

}  // namespace slamdb::python
