// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/build/build.h"

namespace slamdb::detail {

// Throws Error (kUsage) when new keyframes have an IMU and the map's have none, or the other way round, or what it says
// of them does not fit together.
void RequireImu(const Map& map, const NewKeyFrames& given);

// Fills all of a new keyframe that its IMU says, but the links of the chain. `row`: among the new ones.
// Throws Error (kUsage) when its measurements do not add up to finite numbers.
void RecordImu(const NewImu& imu, std::size_t row, KeyFrame& keyframe);

}  // namespace slamdb::detail
