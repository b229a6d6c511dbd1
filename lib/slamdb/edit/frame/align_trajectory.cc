// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/align_trajectory.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/time_offset.h"
#include "slamdb/edit/frame/detail/unpaired.h"
#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

std::vector<TimedPosition> Sorted(std::span<const TimedPosition> reference) {
  std::vector<TimedPosition> sorted(reference.begin(), reference.end());
  std::erase_if(sorted, [](const TimedPosition& sample) { return !std::isfinite(sample.timestamp); });
  std::ranges::stable_sort(sorted, {}, &TimedPosition::timestamp);
  return sorted;
}

std::vector<TimedPosition> PositionsOf(const Map& map, bool body) {
  std::vector<TimedPosition> positions;
  positions.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    const Eigen::Vector3f position = body ? WorldFromBody(keyframe).translation : CameraCenter(keyframe);
    if (position.allFinite()) positions.push_back({keyframe.timestamp, position.cast<double>()});
  }
  return Sorted(positions);
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
  statistics.median = detail::InterpolatedQuantileOf(residuals, 0.5);
  statistics.max = residuals.back();
  return statistics;
}

detail::TimeOffset OffsetOf(const std::vector<TimedPosition>& keyframes, const std::vector<TimedPosition>& samples,
                            const TrajectoryAlignmentOptions& options) {
  const detail::TimeOffset given{options.time_offset, options.time_offset, options.max_time_difference};
  return options.estimate_time_offset ? detail::EstimateTimeOffset(keyframes, samples, options).value_or(given) : given;
}

// Names both time spans, and the offset that would lay one over the other.
Error TooFewPairs(const Map& map, std::size_t pairs, const std::vector<TimedPosition>& keyframes,
                  const std::vector<TimedPosition>& samples, const TrajectoryAlignmentOptions& options) {
  return {ErrorKind::kNotPossible,
          detail::Concat(map.id, ": ", pairs, " of ", detail::Counted(keyframes.size(), "keyframe"),
                         keyframes.size() == 1 ? " has" : " have",
                         " a reference position at their time, but three are needed: ",
                         detail::WhyUnpaired(keyframes, samples,
                                             {.max_time_difference = options.max_time_difference,
                                              .time_offset = options.time_offset,
                                              .whole = "map",
                                              .parts = "keyframes",
                                              .options = "FitOptions"}))};
}

}  // namespace

TrajectoryAlignment AlignToTrajectory(const Map& map, std::span<const TimedPosition> reference,
                                      const TrajectoryAlignmentOptions& options) {
  const auto has_body = [](const KeyFrame& keyframe) { return bool{keyframe.imu_calibration.is_set}; };
  if (options.body && std::ranges::none_of(map.keyframes, has_body))
    throw Error(ErrorKind::kNotPossible,
                ToString(map.id) + " has no IMU calibration, so that nobody knows where its body is");
  const std::vector<TimedPosition> samples = Sorted(reference), keyframes = PositionsOf(map, options.body);
  const detail::TimeOffset offset = OffsetOf(keyframes, samples, options);
  const auto [times, source, target] = detail::PairsAt(keyframes, samples, offset.seconds, offset.reach);
  if (source.size() < detail::kFewestPairs) throw TooFewPairs(map, source.size(), keyframes, samples, options);
  UmeyamaResult fit;
  try {
    fit = SolveUmeyama(source, target, options.fit);
  } catch (const Error& error) {
    throw Error(error.kind(), ToString(map.id) + ": " + error.problem());
  }
  TrajectoryAlignment alignment{.reference_from_map = fit.target_from_source,
                                .keyframes = keyframes.size(),
                                .pairs = source.size(),
                                .largest_residual = std::ranges::max(fit.residuals),
                                .time_offset = offset.seconds,
                                .rival_time_offset = offset.rival,
                                .spread = fit.spread};
  std::vector<double> inliers;
  for (std::size_t pair = 0; pair < fit.residuals.size(); ++pair)
    if (fit.inliers[pair] != 0)
      inliers.push_back(fit.residuals[pair]);
    else
      alignment.outliers.push_back({times[pair], fit.residuals[pair]});
  std::ranges::stable_sort(alignment.outliers, std::greater<>(), &OutlierPair::residual);
  alignment.inliers = inliers.size();
  alignment.residuals = StatisticsOf(std::move(inliers));
  return alignment;
}

std::vector<TimedPosition> TrajectoryOf(const Atlas& atlas, bool body) {
  std::vector<const Map*> maps;
  for (const Map& map : atlas.maps)
    if (!map.keyframes.empty()) maps.push_back(&map);
  if (maps.size() != 1)
    throw Error(ErrorKind::kNotPossible, detail::Concat("must hold one trajectory, not ", maps.size()));
  return PositionsOf(*maps.front(), body);
}

}  // namespace slamdb
