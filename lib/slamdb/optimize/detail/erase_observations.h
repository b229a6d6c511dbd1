// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "slamdb/optimize/detail/measurements.h"

namespace slamdb::detail {

// Erases measurements on both sides: of the point its observation, or the side of a fisheye pair; of the keyframe its
// slot. Counts are made right, and a reference keyframe that no longer sees its point is replaced by the observer with
// the lowest id. Returns, by row, the points that are left with so little that ORB-SLAM3 culls them.
std::vector<std::uint8_t> EraseObservations(std::span<const Measurement* const> measurements, Map& map);

}  // namespace slamdb::detail
