// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/model/atlas.h"

namespace slamdb {

// Makes `root` the root of its spanning tree by turning round the chain of parents from it to the old root, as
// ORB-SLAM3 does when it merges maps. The root's parent is then none. Map::first_keyframe and the like stay as they
// are. Does nothing when `root` is not in the map or already a root. Linear in the chain; ends on cycles.
void RerootTree(Map& map, KeyFrameId root);

// Gives every keyframe whose parent is none, itself, not in the map, or not connected with the root (a cycle), a parent
// that is: of all pairs of an orphan and a covisible keyframe in the tree the one with the greatest weight first, as
// ORB-SLAM3's KeyFrame::SetBadFlag does; orphans without one hang on the keyframe before them in time, or on the root.
// Children are made to agree with parents. The root is Map::first_keyframe, which must be in the map. Returns how many
// keyframes got another parent; a sound tree stays as it is. O(E log E) in the covisibility edges of orphans.
std::size_t AdoptOrphans(Map& map);

}  // namespace slamdb
