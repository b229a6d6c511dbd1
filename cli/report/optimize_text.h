// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/optimize/optimize.h"

namespace slamdb::cli {

// What was optimised, for people: a block for each map.
std::string OptimizeText(const OptimizeReport& report);

// What a user should know of it; `remedy` for what has not settled.
void WarnOf(const MapOptimization& map, const std::string& remedy, Notices& notices);

}  // namespace slamdb::cli
