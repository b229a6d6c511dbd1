// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/optimize/optimize.h"

namespace slamdb::cli {

// What was optimised, for people: a block for each map.
std::string OptimizeText(const OptimizeReport& report);

}  // namespace slamdb::cli
