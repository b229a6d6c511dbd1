// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/json.h"
#include "slamdb/optimize/optimize.h"

namespace slamdb::detail {

// What ToJson writes of a map, for reports that say more.
Json OptimizationJson(const MapOptimization& optimization);

}  // namespace slamdb::detail
