// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Makes an atlas safe for ORB-SLAM3's own loader without touching what the map means: drops maps listed twice (it wipes
// those), empty maps, null and repeated list entries; zeroes members that the writer left uninitialised (merge scale,
// preintegration and body position without IMU, noise of an unset calibration), points references to a reference
// keyframe outside the map at an observer, and makes flags 0 or 1. Returns one sentence for each kind of change, with
// its count; none when nothing had to change, and then the atlas is as it was.
std::vector<std::string> SanitizeForOrbslam3(Atlas& atlas);

}  // namespace slamdb::detail
