// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/optimize/optimize.h"

// What a user should know of an optimisation.
namespace slamdb {

// That which is usual for the constraints: them alone, or all where there are none.
[[nodiscard]] SLAMDB_EXPORT OptimizeMethod UsualMethod(const std::vector<PoseConstraint>& constraints);

// Throws Error (kNotPossible) when nothing was optimised.
SLAMDB_EXPORT void RequireOptimized(const OptimizeReport& report);

// Of one map; `remedy` for what has not settled.
SLAMDB_EXPORT void TellWarnings(const MapOptimization& map, const std::string& remedy, Notices& notices);

}  // namespace slamdb
