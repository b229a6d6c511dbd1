// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/evaluate/detail/pair_poses.h"

namespace slamdb::detail {

// How much of each other the trajectories cover; the estimate is aligned. There is a pair.
TrajectoryCoverage CoverageOf(const PairedTrajectories& paired);

}  // namespace slamdb::detail
