// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/build/build.h"

// Atlases as a SLAM system has them, in columns.
namespace slamdb {

// The keyframes of a map of one camera, or one pair; its points, and the observations that both sides say.
NewKeyFrames KeyFramesOf(const Map& map);
NewPoints PointsOf(const Map& map);

// An atlas that is built of the columns of another one, and nothing else.
Atlas BuiltAnew(const Atlas& atlas);

// What ORB-SLAM3 would stumble over, or `check` warns of, a line each. `ignored`: rules.
std::string TroublesOf(const Atlas& atlas, std::vector<std::string> ignored = {});

}  // namespace slamdb
