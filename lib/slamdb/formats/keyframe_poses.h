// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/keyframe_pose.h"

namespace slamdb {

// The poses of any input that holds some: by time of trajectories, by id of all others, with scales of their own where
// the format has them (g2o's similarities). Bad keyframes are left out.
// `points`, when given, receives where the points are of an input that has some, by id: those that keyframes see, since
// nothing has moved the others.
// `origin`, when given, receives what was taken off all positions, where an input reaches too far for the floats of an
// atlas (ColmapReadOptions::origin; poses of graphs and trajectories alike); it is zero otherwise. Without it graphs
// and trajectories keep their positions.
//
// Throws Error as ReadAtlas.
[[nodiscard]] SLAMDB_EXPORT std::vector<KeyFramePose> ReadKeyFramePoses(const HeldSource& held,
                                                                        const ReadOptions& options = {},
                                                                        Notices* notices = nullptr,
                                                                        std::vector<PointPosition>* points = nullptr,
                                                                        Eigen::Vector3d* origin = nullptr);

}  // namespace slamdb
