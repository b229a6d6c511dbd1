// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/umeyama.h"

namespace slamdb {

struct TimedPosition {
  double timestamp = 0;                                // seconds
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of a reference: not a number where it is known to have none
};

struct TrajectoryAlignmentOptions {
  double max_time_difference = 0.02;  // seconds, between a keyframe and the nearest position
  bool body = false;                  // positions are those of the body (IMU), not of the camera
  double time_offset = 0;             // seconds that the reference's clock is ahead of the map's
  bool estimate_time_offset = false;  // find it instead
  UmeyamaOptions fit;
};

// A pair that was left out because it is far off where the others agree.
struct OutlierPair {
  double timestamp = 0;  // of the keyframe, seconds
  double residual = 0;   // units of the reference
};

// Of distances in units of the reference; all 0 when there are none.
struct ResidualStatistics {
  double rmse = 0, mean = 0, median = 0, max = 0;  // the median of an even number is the mean of the two middle ones
};

struct TrajectoryAlignment {
  Similarity3d reference_from_map;
  std::size_t keyframes = 0;          // that are good and finite
  std::size_t pairs = 0;              // of them with a position at their time
  std::size_t inliers = 0;            // of the pairs, that the transform was solved from
  ResidualStatistics residuals;       // of the inliers
  double largest_residual = 0;        // of all pairs
  std::vector<OutlierPair> outliers;  // the other pairs, the farthest first
  double time_offset = 0;             // seconds that the reference's clock is ahead, as given or estimated
  double rival_time_offset = 0;       // another one that fits nearly as well; the same when there is none
  double spread = 0;  // RMS distance of the inliers' positions from their mean, to hold residuals against
};

// The similarity that lays the keyframes of a map onto a reference trajectory.
// Each keyframe is paired with the position at its time, interpolated where the two samples around it are at most twice
// the greatest time difference apart, and the nearest in time otherwise; then SolveUmeyama.
// `reference` may be in any order.
//
// Throws Error (kNotPossible) when fewer than three keyframes find a position (naming both time spans and the offset
// between them), when these do
// not determine the transform, and when the body is asked for in a map without IMU calibration.
// Cost: O(n log n); estimating the time offset takes up to a second for thousands of keyframes.
[[nodiscard]] SLAMDB_EXPORT TrajectoryAlignment AlignToTrajectory(const Map& map,
                                                                  std::span<const TimedPosition> reference,
                                                                  const TrajectoryAlignmentOptions& options = {});

// The good keyframes of the only map that has any, in order of time, as a reference for others.
//
// Throws Error (kNotPossible) when there are several such maps, or none.
// Cost: O(n log n).
[[nodiscard]] SLAMDB_EXPORT std::vector<TimedPosition> TrajectoryOf(const Atlas& atlas, bool body = false);

}  // namespace slamdb
