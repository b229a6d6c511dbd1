// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

// What most keyframes of a map hold.
[[nodiscard]] SLAMDB_EXPORT MapSensor SensorOf(const Map& map);

// Calibrated keyframes, or the map says it is inertial.
[[nodiscard]] SLAMDB_EXPORT bool HasImu(const Map& map);

}  // namespace slamdb
