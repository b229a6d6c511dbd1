// SPDX-License-Identifier: BSD-3-Clause
// 1. Poses of one time are paired (pair_poses.cc), and the estimate is laid onto the truth (align.cc).
// 2. Absolute errors are between the two poses of a pair.
// 3. Relative ones are between the motions from one pair to another (relative_pairs.cc), which no rigid alignment
//    changes.
// Of an error the distance and the angle are kept; the matrix norms of the literature follow from these.
#include "slamdb/evaluate/evaluate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/detail/align.h"
#include "slamdb/evaluate/detail/coverage.h"
#include "slamdb/evaluate/detail/pair_poses.h"
#include "slamdb/evaluate/detail/relative_pairs.h"
#include "slamdb/model/umeyama.h"

namespace slamdb {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// |R - I| of a rotation by an angle.
double RotationPart(double degrees) { return 2 * std::numbers::sqrt2 * std::sin(degrees / kDegreesPerRadian / 2); }

// Statistics that are still to be computed: of so many errors, each by its place.
struct Series {
  ErrorStatistics* statistics;
  std::size_t count;
  std::function<double(std::size_t)> error;
};

void Compute(const std::vector<Series>& series, int threads) {
  detail::ParallelFor(series.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<double> errors;
      errors.reserve(series[i].count);
      for (std::size_t place = 0; place < series[i].count; ++place)
        if (const double error = series[i].error(place); !std::isnan(error)) errors.push_back(error);
      *series[i].statistics = ErrorStatisticsOf(std::move(errors));
    }
  });
}

// Errors that have a translation and a rotation, absolute and relative ones alike.
template <class Statistics, class Errors, class Error>
void AddSeries(Statistics& to, const Errors& errors, double Error::*translation, double Error::*degrees,
               std::vector<Series>& series) {
  const auto add = [&](ErrorStatistics& statistics, auto error) {
    series.push_back({&statistics, errors.size(), error});
  };
  add(to.translation, [&errors, translation](std::size_t i) { return errors[i].*translation; });
  add(to.rotation_degrees, [&errors, degrees](std::size_t i) { return errors[i].*degrees; });
  add(to.rotation_part, [&errors, degrees](std::size_t i) { return RotationPart(errors[i].*degrees); });
  add(to.full_transformation, [&errors, translation, degrees](std::size_t i) {
    return std::hypot(errors[i].*translation, RotationPart(errors[i].*degrees));
  });
}

std::vector<PairedPose> PosesOf(const detail::PairedTrajectories& paired) {
  std::vector<PairedPose> poses;
  poses.reserve(paired.pairs.size());
  for (const auto& [mine, truth] : paired.pairs) {
    const TrajectoryPose &estimate = paired.estimate[mine], &reference = paired.reference[truth];
    poses.push_back({.timestamp = estimate.timestamp,
                     .reference_timestamp = reference.timestamp,
                     .position = estimate.position,
                     .reference_position = reference.position,
                     .rotation = estimate.rotation,
                     .reference_rotation = reference.rotation,
                     .translation_error = (estimate.position - reference.position).norm(),
                     .rotation_error_degrees =
                         kDegreesPerRadian * detail::AngleOf(estimate.rotation.conjugate() * reference.rotation)});
  }
  return poses;
}

detail::Path PathOf(const std::vector<PairedPose>& poses, bool of_reference) {
  detail::Path path;
  for (const PairedPose& pose : poses) {
    path.times.push_back(of_reference ? pose.reference_timestamp : pose.timestamp);
    path.positions.push_back(of_reference ? pose.reference_position : pose.position);
    path.rotations.push_back(of_reference ? pose.reference_rotation : pose.rotation);
  }
  return path;
}

RelativeErrors RelativeErrorsOf(const std::vector<PairedPose>& poses, const detail::Path& path, const Delta& delta,
                                const EvaluationOptions& options) {
  RelativeErrors relative{.delta = delta};
  const detail::IndexPairs pairs = detail::PairsApart(path, delta, options);
  relative.errors.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    const PairedPose &from = poses[i], &to = poses[j];
    const Eigen::Vector3d moved = from.rotation.conjugate() * (to.position - from.position);
    const Eigen::Vector3d truly_moved =
        from.reference_rotation.conjugate() * (to.reference_position - from.reference_position);
    const Eigen::Quaterniond turned = from.rotation.conjugate() * to.rotation;
    const Eigen::Quaterniond truly_turned = from.reference_rotation.conjugate() * to.reference_rotation;
    relative.errors.push_back(
        {.from = i,
         .to = j,
         .translation = (moved - truly_moved).norm(),
         .rotation_degrees = kDegreesPerRadian * detail::AngleOf(truly_turned.conjugate() * turned)});
  }
  return relative;
}

void AddRelativeSeries(RelativeErrors& relative, const std::vector<PairedPose>& poses, std::vector<Series>& series) {
  const std::vector<RelativeError>& errors = relative.errors;
  AddSeries(relative, errors, &RelativeError::translation, &RelativeError::rotation_degrees, series);
  const auto true_distance = [&poses](const RelativeError& error) {
    return (poses[error.to].reference_position - poses[error.from].reference_position).norm();
  };
  const auto difference = [&poses, true_distance](const RelativeError& error) {
    return std::abs((poses[error.to].position - poses[error.from].position).norm() - true_distance(error));
  };
  series.push_back({&relative.point_distance, errors.size(),
                    [&errors, difference](std::size_t i) { return difference(errors[i]); }});
  series.push_back({&relative.point_distance_ratio, errors.size(), [&errors, difference, true_distance](std::size_t i) {
                      const double distance = true_distance(errors[i]);
                      return distance == 0 ? ErrorStatistics::kNone : 100 * (difference(errors[i]) / distance);
                    }});
}

// ---- warnings

// RMS distance of the paired positions of one side from their mean.
double SpreadOf(const std::vector<PairedPose>& poses, Eigen::Vector3d PairedPose::*position) {
  const auto count = static_cast<double>(poses.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PairedPose& pose : poses) mean += pose.*position / count;
  double squares = 0;
  for (const PairedPose& pose : poses) squares += (pose.*position - mean).squaredNorm();
  return std::sqrt(squares / count);
}

void Warn(TrajectoryEvaluation& evaluation) {
  constexpr double kOtherScale = 0.1, kFewPairs = 0.5;
  std::vector<std::string>& warnings = evaluation.warnings;
  const AppliedAlignment& alignment = evaluation.alignment;
  if (alignment.on_line)
    warnings.push_back(
        "the paired poses lie on one line, and do not determine the rotation about it: absolute errors of rotation "
        "mean little");
  if (const double share = evaluation.coverage.paired_share(); share < kFewPairs)
    warnings.push_back(detail::Concat("only ", evaluation.coverage.pairs, " of ",
                                      detail::Counted(evaluation.coverage.estimate_poses, "pose"),
                                      " have a pose of the truth at their time"));
  const double spread = SpreadOf(evaluation.poses, &PairedPose::reference_position);
  if (alignment.kind == AlignmentKind::kSe3 || alignment.kind == AlignmentKind::kSim3)
    if (const auto poor = PoorFitWarning(evaluation.absolute.translation.rmse, spread)) warnings.push_back(*poor);
  const double ratio = spread / SpreadOf(evaluation.poses, &PairedPose::position);
  if (alignment.kind != AlignmentKind::kSim3 && alignment.kind != AlignmentKind::kScale && ratio > 0 &&
      std::abs(std::log(ratio)) > std::log1p(kOtherScale) && std::isfinite(ratio))
    warnings.push_back(detail::Concat("the poses of the truth spread ", detail::Digits(ratio, 3),
                                      " times as far: the scale of the estimate may be open, which "
                                      "EvaluationOptions::alignment sim3 solves for"));
  for (const RelativeErrors& relative : evaluation.relative)
    if (relative.errors.empty())
      warnings.push_back(detail::Concat("no two paired poses are ", relative.delta, " apart"));
}

void RequireOptions(const EvaluationOptions& options) {
  const auto require = [](bool holds, std::string_view problem) {
    if (!holds) throw Error(ErrorKind::kUsage, std::string(problem));
  };
  require(options.max_time_difference >= 0, "EvaluationOptions::max_time_difference must be 0 or above");
  require(std::isfinite(options.time_offset), "EvaluationOptions::time_offset must be finite");
  require(options.delta_tolerance >= 0, "EvaluationOptions::delta_tolerance must be 0 or above");
}

std::string NameOf(const Estimate& estimate) { return estimate.map ? ToString(estimate.map) + ": " : std::string(); }

Estimate Joined(std::vector<Estimate>&& estimates) {
  Estimate joined;
  for (Estimate& estimate : estimates) {
    joined.open_scale |= estimate.open_scale;
    joined.poses.insert(joined.poses.end(), estimate.poses.begin(), estimate.poses.end());
  }
  std::ranges::stable_sort(joined.poses, {}, &TrajectoryPose::timestamp);
  return joined;
}

}  // namespace

std::string_view NameOf(AlignmentKind kind) {
  constexpr std::array<std::string_view, 5> kNames = {"none", "origin", "scale", "se3", "sim3"};
  return kNames.at(static_cast<std::size_t>(kind));
}

TrajectoryEvaluation EvaluateTrajectory(const Estimate& estimate, std::span<const TrajectoryPose> reference,
                                        const EvaluationOptions& options) {
  RequireOptions(options);
  const AlignmentKind kind =
      options.alignment.value_or(estimate.open_scale ? AlignmentKind::kSim3 : AlignmentKind::kSe3);
  const bool with_scale = kind == AlignmentKind::kSim3 || kind == AlignmentKind::kScale;
  detail::PairedTrajectories paired = detail::PairPoses(estimate.poses, reference, with_scale, options);
  TrajectoryEvaluation evaluation;
  if (estimate.map) evaluation.maps = {estimate.map};
  evaluation.alignment = detail::Align(paired, kind, options);
  evaluation.time_offset = paired.time_offset;
  evaluation.coverage = detail::CoverageOf(paired);
  evaluation.warnings = std::move(paired.warnings);
  evaluation.poses = PosesOf(paired);
  const detail::Path path = PathOf(evaluation.poses, options.pairs_from_reference);
  for (const Delta& delta : options.deltas)
    evaluation.relative.push_back(RelativeErrorsOf(evaluation.poses, path, delta, options));
  std::vector<Series> series;
  AddSeries(evaluation.absolute, evaluation.poses, &PairedPose::translation_error, &PairedPose::rotation_error_degrees,
            series);
  for (RelativeErrors& relative : evaluation.relative) AddRelativeSeries(relative, evaluation.poses, series);
  Compute(series, options.threads);
  Warn(evaluation);
  return evaluation;
}

EvaluationReport EvaluateTrajectories(std::vector<Estimate> estimates, std::span<const TrajectoryPose> reference,
                                      const EvaluationOptions& options) {
  if (estimates.empty()) throw Error(ErrorKind::kNotPossible, "has no trajectory to evaluate");
  EvaluationReport report;
  if (options.joint) {
    std::vector<MapId> maps;
    for (const Estimate& estimate : estimates)
      if (estimate.map) maps.push_back(estimate.map);
    report.evaluations.push_back(EvaluateTrajectory(Joined(std::move(estimates)), reference, options));
    report.evaluations.front().maps = maps;
    return report;
  }
  detail::Steps steps(options.progress, "evaluating", estimates.size());
  for (const Estimate& estimate : estimates) {
    try {
      report.evaluations.push_back(EvaluateTrajectory(estimate, reference, options));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kNotPossible || estimates.size() == 1)
        throw Error(error.kind(), NameOf(estimate) + error.problem());
      report.unevaluated.push_back({estimate.map, error.problem()});
    }
    steps.Next();
  }
  if (report.evaluations.empty())
    throw Error(ErrorKind::kNotPossible, "none of " + detail::Counted(estimates.size(), "map") + " can be evaluated; " +
                                             NameOf(estimates.front()) + report.unevaluated.front().reason);
  return report;
}

}  // namespace slamdb
