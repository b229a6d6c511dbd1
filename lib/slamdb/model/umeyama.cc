// SPDX-License-Identifier: BSD-3-Clause
// 1. Without an outlier distance every pair is an inlier, or all but gross outliers: of the transforms of three pairs
//    drawn at random the one whose median residual is least says which (LMedS, Rousseeuw 1984). Otherwise three pairs
//    drawn at random are solved again and again, and the transform that most pairs agree with says which are inliers
//    (RANSAC, Fischler and Bolles 1981).
// 2. The inliers are solved by least squares, which says anew which pairs are inliers, until these stay the same.
#include "slamdb/model/umeyama.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/ransac.h"

namespace slamdb {
namespace {

using Points = std::span<const Eigen::Vector3d>;
using Rows = std::vector<std::size_t>;

constexpr std::size_t kFewestPairs = 3;
constexpr int kMostDraws = 1000, kMostRefinements = 50;
constexpr double kConfidence = 0.9999;

// Of the cross-covariance, second singular value to first: below it the points lie on one line, within a thousandth of
// its length, and the rotation about that line is noise.
constexpr double kLineRatio = 1e-6;
// Of the spread of points to their distance from the origin: below it they are one place, which rounding spreads.
constexpr double kPlaceRatio = 1e-10;
// From the origin in each direction. Squares of squares still fit into a double.
constexpr double kMostDistance = 1e70;

struct Solution {
  Similarity3d target_from_source;
  bool on_line = false;
};

// Least squares over some of the pairs; nullopt when they are in one place, which tells no rotation at all.
std::optional<Solution> SolveAlsoLines(Points source, Points target, const Rows& rows, bool with_scale) {
  const auto count = static_cast<double>(rows.size());
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero(), target_mean = Eigen::Vector3d::Zero();
  for (const std::size_t row : rows) {
    source_mean += source[row] / count;
    target_mean += target[row] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0, target_variance = 0;
  for (const std::size_t row : rows) {
    const Eigen::Vector3d from_mean = source[row] - source_mean, target_from_mean = target[row] - target_mean;
    covariance += target_from_mean * from_mean.transpose() / count;
    variance += from_mean.squaredNorm() / count;
    target_variance += target_from_mean.squaredNorm() / count;
  }
  const auto is_place = [](double squares, const Eigen::Vector3d& mean) {
    return !(squares > kPlaceRatio * kPlaceRatio * mean.squaredNorm());
  };
  if (is_place(variance, source_mean) || is_place(target_variance, target_mean)) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d singular = svd.singularValues();
  const double handedness = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Eigen::Vector3d signs(1, 1, handedness);
  Similarity3d result;
  result.rotation = Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose()));
  result.rotation.normalize();
  if (with_scale) result.scale = singular.dot(signs) / variance;
  result.translation = target_mean - result.scale * (result.rotation * source_mean);
  return Solution{result, !(singular[1] > kLineRatio * singular[0])};
}

// The same; nullopt also when they lie on one line.
std::optional<Similarity3d> Solve(Points source, Points target, const Rows& rows, bool with_scale) {
  const auto solution = SolveAlsoLines(source, target, rows, with_scale);
  return solution && !solution->on_line ? std::optional(solution->target_from_source) : std::nullopt;
}

// Root mean square of `distance(row)` over the rows.
template <class Distance>
double RootMeanSquare(const Rows& rows, const Distance& distance) {
  double squares = 0;
  for (const std::size_t row : rows) squares += distance(row) * distance(row);
  return std::sqrt(squares / static_cast<double>(rows.size()));
}

double Residual(Points source, Points target, const Similarity3d& transform, std::size_t row) {
  return (target[row] - transform * source[row]).norm();
}

Rows RowsWithin(Points source, Points target, const Similarity3d& transform, double distance) {
  Rows rows;
  for (std::size_t row = 0; row < source.size(); ++row)
    if (Residual(source, target, transform, row) <= distance) rows.push_back(row);
  return rows;
}

// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): the same draws on every machine.
class Draws {
 public:
  explicit Draws(std::size_t count) : count_(count) {}

  Rows Three() {
    Rows rows;
    while (rows.size() < kFewestPairs) {
      const std::size_t row = Next() % count_;
      if (std::ranges::find(rows, row) == rows.end()) rows.push_back(row);
    }
    return rows;
  }

 private:
  std::uint64_t Next() {
    std::uint64_t value = state_ += 0x9E3779B97F4A7C15;
    value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9;
    value = (value ^ value >> 27) * 0x94D049BB133111EB;
    return value ^ value >> 31;
  }

  std::uint64_t count_, state_ = 0;
};

Rows Consensus(Points source, Points target, const UmeyamaOptions& options) {
  Draws draws(source.size());
  Rows best;
  int needed = kMostDraws;
  for (int draw = 0; draw < needed; ++draw) {
    const auto transform = Solve(source, target, draws.Three(), options.with_scale);
    if (!transform || !(transform->scale > 0)) continue;
    Rows rows = RowsWithin(source, target, *transform, options.outlier_distance);
    if (rows.size() <= best.size()) continue;
    best = std::move(rows);
    needed = detail::SamplesNeeded(best.size(), source.size(), kConfidence, kMostDraws);
  }
  if (best.size() < kFewestPairs)
    throw Error(ErrorKind::kNotPossible,
                "no three of " + std::to_string(source.size()) +
                    " pairs of points agree on a transform within the outlier distance; allow a larger one");
  return best;
}

// The least of the residuals that more than half of the pairs stay within; four at least, since three agree easily.
double MedianResidual(Points source, Points target, const Similarity3d& transform) {
  std::vector<double> residuals;
  for (std::size_t row = 0; row < source.size(); ++row) residuals.push_back(Residual(source, target, transform, row));
  const std::size_t middle = std::max<std::size_t>(residuals.size() / 2, 3);
  return detail::ElementInOrder(residuals, middle);
}

double SpreadOf(Points points, const Rows& rows) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t row : rows) mean += points[row] / static_cast<double>(rows.size());
  return RootMeanSquare(rows, [&](std::size_t row) { return (points[row] - mean).norm(); });
}

// The pairs that are no gross outliers of the transform; all of them when less than half are left.
Rows WithoutGross(Points source, Points target, const Similarity3d& transform) {
  constexpr double kSigmas = 10, kShareOfSpread = 0.1;
  const double sigma = 1.4826 * MedianResidual(source, target, transform);
  const double spread = SpreadOf(target, RowsWithin(source, target, transform, 2.5 * sigma));
  return RowsWithin(source, target, transform, std::max(kSigmas * sigma, kShareOfSpread * spread));
}

// All pairs but gross outliers. Few pairs have no majority to tell them by.
Rows PairsButGross(Points source, Points target, bool with_scale) {
  constexpr std::size_t kFewest = 5;
  constexpr int kDraws = 300;  // miss a transform of three inliers among half as many once in 10^17 times
  Rows all(source.size());
  std::iota(all.begin(), all.end(), 0);
  if (source.size() < kFewest) return all;
  Draws draws(source.size());
  std::optional<Similarity3d> best;
  double least = std::numeric_limits<double>::infinity();
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto transform = Solve(source, target, draws.Three(), with_scale);
    if (!transform || !(transform->scale > 0)) continue;
    const double median = MedianResidual(source, target, *transform);
    if (!(median < least)) continue;
    least = median;
    best = transform;
  }
  if (!best) return all;
  Rows rows = WithoutGross(source, target, *best);
  // Three pairs give a rough transform; that of all inliers says better which are.
  for (int round = 0; round < kMostRefinements && rows.size() >= kFewestPairs; ++round) {
    const auto refined = Solve(source, target, rows, with_scale);
    if (!refined || !(refined->scale > 0)) break;
    Rows again = WithoutGross(source, target, *refined);
    if (again == rows) break;
    rows = std::move(again);
  }
  return 2 * rows.size() > source.size() ? rows : all;
}

Solution SolveOrThrow(Points source, Points target, const Rows& rows, const UmeyamaOptions& options, bool accept_line) {
  const auto solution = SolveAlsoLines(source, target, rows, options.with_scale);
  if (!solution || (solution->on_line && !accept_line) || !(solution->target_from_source.scale > 0))
    throw Error(ErrorKind::kNotPossible, "the " + std::to_string(rows.size()) + " pairs of points lie " +
                                             (accept_line ? "" : "on one line, or ") +
                                             "in one place: they do not determine a rotation");
  return *solution;
}

void RequirePoints(Points source, Points target) {
  if (source.size() != target.size())
    throw Error(ErrorKind::kUsage, "points must correspond: there are " + std::to_string(source.size()) + " and " +
                                       std::to_string(target.size()));
  if (source.size() < kFewestPairs)
    throw Error(ErrorKind::kNotPossible,
                "at least 3 pairs of points determine a transform; there are " + std::to_string(source.size()));
  const auto finite = [](const Eigen::Vector3d& point) { return point.allFinite(); };
  if (!std::ranges::all_of(source, finite) || !std::ranges::all_of(target, finite))
    throw Error(ErrorKind::kNotPossible, "a point to align by holds NaN or infinity");
  const auto far = [](const Eigen::Vector3d& point) { return !(point.cwiseAbs().maxCoeff() <= kMostDistance); };
  if (std::ranges::any_of(source, far) || std::ranges::any_of(target, far))
    throw Error(ErrorKind::kNotPossible, detail::Concat("a point to align by is over ", kMostDistance,
                                                        " from the origin, where sums of squares overflow"));
}

}  // namespace

UmeyamaResult SolveUmeyama(Points source, Points target, const UmeyamaOptions& options) {
  RequirePoints(source, target);
  Rows rows(source.size());
  std::iota(rows.begin(), rows.end(), 0);
  const bool robust = options.outlier_distance > 0;
  if (robust)
    rows = Consensus(source, target, options);
  else if (options.leave_out_gross)
    rows = PairsButGross(source, target, options.with_scale);
  UmeyamaResult result;
  const bool accept_line = options.accept_line && !robust && !options.leave_out_gross;
  const Solution solution = SolveOrThrow(source, target, rows, options, accept_line);
  result.target_from_source = solution.target_from_source;
  result.on_line = solution.on_line;
  for (int round = 0; robust && round < kMostRefinements; ++round) {
    Rows again = RowsWithin(source, target, result.target_from_source, options.outlier_distance);
    if (again == rows || again.size() < kFewestPairs) break;
    rows = std::move(again);
    result.target_from_source = SolveOrThrow(source, target, rows, options, accept_line).target_from_source;
  }
  for (std::size_t row = 0; row < source.size(); ++row)
    result.residuals.push_back(Residual(source, target, result.target_from_source, row));
  result.inliers.assign(source.size(), 0);
  for (const std::size_t row : rows) result.inliers[row] = 1;
  result.rms = RootMeanSquare(rows, [&](std::size_t row) { return result.residuals[row]; });
  result.spread = SpreadOf(target, rows);
  return result;
}

std::optional<std::string> PoorFitWarning(double rms, double spread) {
  constexpr double kPoorShare = 0.1;
  if (rms <= kPoorShare * spread) return std::nullopt;
  return detail::Concat("the fit is poor: points that spread by ", detail::Digits(spread, 3), " miss their places by ",
                        detail::Digits(rms, 3),
                        " (RMS); see whether all pairs belong together, or leave out those that are far off");
}

}  // namespace slamdb
