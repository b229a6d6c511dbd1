// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/align_trajectory.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

constexpr std::size_t kFewestPairs = 3;

std::vector<TimedPosition> Sorted(std::span<const TimedPosition> reference) {
  std::vector<TimedPosition> sorted(reference.begin(), reference.end());
  std::erase_if(sorted, [](const TimedPosition& sample) {
    return !std::isfinite(sample.timestamp) || !sample.position.allFinite();
  });
  std::ranges::stable_sort(sorted, {}, &TimedPosition::timestamp);
  return sorted;
}

std::vector<TimedPosition> PositionsOf(const Map& map, bool body) {
  std::vector<TimedPosition> positions;
  positions.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    const Eigen::Vector3f position = body ? WorldFromBody(keyframe).translation : CameraCenter(keyframe);
    positions.push_back({keyframe.timestamp, position.cast<double>()});
  }
  return Sorted(positions);
}

// The reference at a time.
std::optional<Eigen::Vector3d> PositionAt(const std::vector<TimedPosition>& reference, double time, double most) {
  const auto after = std::ranges::lower_bound(reference, time, {}, &TimedPosition::timestamp);
  const double to_after = after == reference.end() ? INFINITY : after->timestamp - time;
  if (after == reference.begin()) return to_after <= most ? std::optional(after->position) : std::nullopt;
  const auto before = after - 1;
  const double to_before = time - before->timestamp;
  if (std::min(to_before, to_after) > most) return std::nullopt;
  const double gap = to_before + to_after;
  if (gap > 2 * most) return to_before < to_after ? before->position : after->position;
  return Eigen::Vector3d(before->position + to_before / gap * (after->position - before->position));
}

std::string Span(const std::vector<TimedPosition>& positions) {
  if (positions.empty()) return "no time at all";
  return detail::Concat(detail::Fixed(positions.front().timestamp, 3), " to ",
                        detail::Fixed(positions.back().timestamp, 3), " s");
}

ResidualStatistics StatisticsOf(std::vector<double> residuals) {
  ResidualStatistics statistics;
  if (residuals.empty()) return statistics;
  std::ranges::sort(residuals);
  const auto count = static_cast<double>(residuals.size());
  double squares = 0;
  for (const double residual : residuals) {
    statistics.mean += residual / count;
    squares += residual * residual / count;
  }
  statistics.rmse = std::sqrt(squares);
  statistics.median = residuals[residuals.size() / 2];
  statistics.max = residuals.back();
  return statistics;
}

}  // namespace

TrajectoryAlignment AlignToTrajectory(const Map& map, std::span<const TimedPosition> reference,
                                      const TrajectoryAlignmentOptions& options) {
  const auto has_body = [](const KeyFrame& keyframe) { return bool{keyframe.imu_calibration.is_set}; };
  if (options.body && std::ranges::none_of(map.keyframes, has_body))
    throw Error(ErrorKind::kNotPossible,
                ToString(map.id) + " has no IMU calibration, so that nobody knows where its body is");
  const std::vector<TimedPosition> samples = Sorted(reference), keyframes = PositionsOf(map, options.body);
  std::vector<Eigen::Vector3d> source, target;
  for (const auto& [time, position] : keyframes) {
    const auto there = PositionAt(samples, time, options.max_time_difference);
    if (!there) continue;
    source.push_back(position);
    target.push_back(*there);
  }
  if (source.size() < kFewestPairs)
    throw Error(ErrorKind::kNotPossible,
                ToString(map.id) + ": " + std::to_string(source.size()) + " of " + std::to_string(keyframes.size()) +
                    " keyframes have a reference position at their time, but three are needed: the map covers " +
                    Span(keyframes) + ", the reference " + Span(samples));
  UmeyamaResult fit;
  try {
    fit = SolveUmeyama(source, target, options.fit);
  } catch (const Error& error) {
    throw Error(error.kind(), ToString(map.id) + ": " + error.problem());
  }
  std::vector<double> inliers;
  for (std::size_t pair = 0; pair < fit.residuals.size(); ++pair)
    if (fit.inliers[pair] != 0) inliers.push_back(fit.residuals[pair]);
  return {.reference_from_map = fit.target_from_source,
          .keyframes = keyframes.size(),
          .pairs = source.size(),
          .inliers = inliers.size(),
          .residuals = StatisticsOf(inliers),
          .largest_residual = std::ranges::max(fit.residuals),
          .spread = fit.spread};
}

std::vector<TimedPosition> TrajectoryOf(const Atlas& atlas, bool body) {
  std::vector<const Map*> maps;
  for (const Map& map : atlas.maps)
    if (!map.keyframes.empty()) maps.push_back(&map);
  if (maps.size() != 1)
    throw Error(ErrorKind::kNotPossible, detail::Concat("must hold one trajectory, not ", maps.size()));
  return PositionsOf(*maps.front(), body);
}

bool HasOpenScale(const Map& map) {
  if (map.imu_initialized) return false;
  return std::ranges::none_of(map.keyframes, [](const KeyFrame& keyframe) {
    return keyframe.features.is_fisheye_stereo() ||
           std::ranges::any_of(keyframe.features.depth, [](float depth) { return depth > 0; });
  });
}

}  // namespace slamdb
