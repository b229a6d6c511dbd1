// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/align/optimize_joined.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/export.h"

namespace slamdb {

struct MergeBranchesResult {
  ThreeWayResult merged;
  std::vector<OptimizedJoin> tightened;  // rounds, with BranchGeometry::kOptimize
};

// MergeThreeWays, and with BranchGeometry::kOptimize what follows on joining: every picture that one side took is
// searched for points that the other made, and the bundle of each map that both had a part in is adjusted, twice. A
// side that is the base, or was merged before, leaves nothing to optimise. Id maps follow.
//
// Throws Error as MergeThreeWays; kUnsupported, before anything else, where this slamdb was built without Ceres.
[[nodiscard]] SLAMDB_EXPORT MergeBranchesResult MergeBranches(Atlas base, Atlas ours, Atlas theirs,
                                                              const ThreeWayOptions& options = {});

[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MergeBranchesResult& result, const std::string& output = {});

}  // namespace slamdb
