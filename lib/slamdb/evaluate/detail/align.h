// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/evaluate/detail/pair_poses.h"

namespace slamdb::detail {

// Finds how the estimate is laid onto the truth, from the pairs, and lays it there.
//
// Throws Error (kNotPossible): too few pairs, or all in one place.
AppliedAlignment Align(PairedTrajectories& paired, AlignmentKind kind, const EvaluationOptions& options);

}  // namespace slamdb::detail
