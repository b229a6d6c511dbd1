// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"
#include "slamdb/formats/rtabmap/detail/keyframes.h"
#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb::rtabmap {

// One map of all nodes that RTAB-Map optimised, or that odometry ties to such; one of each session that has none.
// A keyframe for each camera of a node; with one camera, of the node's id.
Atlas ReadAtlas(sqlite::Database& database, const ReadOptions& options, Notices& notices);

// Where the first cameras of the nodes truly were, or, without pictures, the robot.
Atlas ReadTruth(sqlite::Database& database, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::rtabmap
