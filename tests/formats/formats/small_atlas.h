// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

namespace slamdb {

// Two maps made by hand, with numbers that are exact in float, so that tests can spell out every byte.
// Map 0: keyframes 3 (1.5 s) and 1 (0.5 s), in this order; points 10 (seen by both, errors 0 and 5 pixels), 11 (bad)
// and 12 (never seen). Map 1: keyframe 7 (2 s), its axes turned from x y z to y z x, and its point 20.
Atlas SmallAtlas();

// SmallAtlas() with two landmarks in map 0, of point 10 and empty, and one in map 1.
Atlas LandmarkAtlas();

// SmallAtlas() without map 1.
Atlas OneMapAtlas();

// OneMapAtlas() with IMU calibration, velocities and biases: the body is 1 m in front of the camera.
Atlas InertialAtlas();

}  // namespace slamdb
