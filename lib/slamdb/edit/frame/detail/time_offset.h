// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "slamdb/edit/frame/align_trajectory.h"

namespace slamdb::detail {

// A position of a sorted trajectory at a time: interpolated where the two samples around it are at most twice `most`
// seconds apart, and the nearest within `most` otherwise; none where that one has no position.
std::optional<Eigen::Vector3d> PositionAt(const std::vector<TimedPosition>& reference, double time, double most);

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
