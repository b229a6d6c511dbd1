// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slamdb/edit/frame/align_trajectory.h"

namespace slamdb::detail {

// The keyframes that find a position in a sorted reference whose clock is ahead by `offset`, and those positions:
// interpolated where the two samples around one are at most twice `most` seconds apart, and the nearest within `most`
// otherwise; none where that one has no position.
struct Pairs {
  std::vector<double> times;  // of the keyframes
  std::vector<Eigen::Vector3d> source, target;
};
Pairs PairsAt(const std::vector<TimedPosition>& keyframes, const std::vector<TimedPosition>& reference, double offset,
              double most);

inline constexpr std::size_t kFewestPairs = 3;

struct TimeOffset {
  double seconds = 0;  // that the reference's clock is ahead of the keyframes'
  double rival = 0;    // another offset that fits nearly as well; the same when there is none
  double reach = 0;    // how far apart keyframes and positions may then be: their samples no longer coincide
};

// How far the clock of a reference is ahead: of the offsets under which at least half of the shorter trajectory
// overlaps, those at which speeds correlate best, and of these the one whose alignment leaves the least.
// Both are sorted by time. Nothing when no offset lets three keyframes find a position.
std::optional<TimeOffset> EstimateTimeOffset(const std::vector<TimedPosition>& keyframes,
                                             const std::vector<TimedPosition>& reference,
                                             const TrajectoryAlignmentOptions& options);

}  // namespace slamdb::detail
