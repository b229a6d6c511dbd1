// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"
#include "slamdb/model/statistics.h"

// What statistics and summaries of a map have in common.
namespace slamdb::detail {

// Whether a keyframe has points whose depth it measured: stereo, a depth camera, two fisheye cameras.
bool MeasuresDepth(const KeyFrame& keyframe);

// Of good keyframes with a finite timestamp, and through their finite camera centres by time.
struct Trajectory {
  bool empty = true;
  double begin_time = 0, end_time = 0;  // seconds
  double length = 0;                    // metres or map units
};
Trajectory TrajectoryOf(const Map& map);

}  // namespace slamdb::detail
