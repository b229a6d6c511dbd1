// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/synthetic/detail/portable.h"
#include "slamdb/synthetic/detail/rig.h"

// What follows from which keyframe sees which point. The keyframes of `map` stand in id order with their features and
// poses set; row r of the lists is id `first id + r`. Linear in the number of observations.
namespace slamdb::synthetic {

// Fills the points' side of every observation, then all that MapPoint::UpdateNormalAndDepth and
// ComputeDistinctiveDescriptors of ORB-SLAM3 would: counts, normals, distance ranges, descriptors. The reference
// keyframe is the first observer. `world_from_camera` are the keyframes' poses.
void ConnectPoints(Map& map, const Rig& rig, const std::vector<Pose>& world_from_camera, int threads);

// Covisibility (shared points) and the spanning tree: the parent of a keyframe is the one among those before it that
// shares most points, the latest of equals.
void ConnectKeyFrames(Map& map, int threads);

// A loop edge, both ways, between two rows.
void AddLoopEdge(Map& map, std::size_t row, std::size_t other_row);

}  // namespace slamdb::synthetic
