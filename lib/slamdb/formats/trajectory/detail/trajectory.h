// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Keyframe poses as text: world_from_camera, or world_from_body with TrajectoryOptions::pose_frame. Sorted by time;
// several maps stand one behind the other, by their place in the atlas. schema/trajectory.md has the lines.
extern const Format kTumFormat;    // tum: `seconds x y z qx qy qz qw`, read and write
extern const Format kKittiFormat;  // kitti: rows of 3x4 matrices, seconds in a second file, PATH.times, read and write
extern const Format kEurocFormat;  // euroc: the csv of the EuRoC ground truth, nanoseconds, read and write

}  // namespace slamdb::detail
