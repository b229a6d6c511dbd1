// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slamdb/evaluate/evaluate.h"

namespace slamdb::detail {

using Poses = std::vector<TrajectoryPose>;

// Two trajectories and which of their poses belong together.
struct PairedTrajectories {
  struct Pair {
    std::size_t estimate = 0, reference = 0;
  };

  Poses estimate, reference;  // finite; by time, unless they were paired by index
  std::vector<Pair> pairs;    // in order of time
  double time_offset = 0;     // as given or estimated
  std::vector<std::string> warnings;
};

// `with_scale`: a time offset that is sought may scale the estimate.
//
// Throws Error as EvaluateTrajectory, but that it finds no fault with few pairs.
PairedTrajectories PairPoses(std::span<const TrajectoryPose> estimate, std::span<const TrajectoryPose> reference,
                             bool with_scale, const EvaluationOptions& options);

// Why there are so few pairs, and what may help.
std::string WhyFewPairs(const PairedTrajectories& paired, const EvaluationOptions& options);

}  // namespace slamdb::detail
