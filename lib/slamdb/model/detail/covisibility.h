// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Counts anew with which keyframes those at `rows` of the map share points, as ORB-SLAM3's KeyFrame::UpdateConnections
// does: a keyframe's connections become all that it shares points with; of these, whoever shares 15 or more, or the one
// that shares most if nobody does, gets the same weight back. Keyframes that share no points keep what they had.
// Parents stay. Linear in the observers of the points that the keyframes see.
void UpdateCovisibility(Map& map, std::span<const std::uint32_t> rows);

}  // namespace slamdb::detail
