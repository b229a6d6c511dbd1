// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// What follows when other keyframes see points: their most distinctive descriptor and their viewing direction, and the
// covisibility of all that see them. Points that are not there are passed over.
// Returns how many keyframes that was.
// Cost: linear.
std::uint64_t RefreshPoints(Map& map, std::vector<MapPointId> points);

}  // namespace slamdb::detail
