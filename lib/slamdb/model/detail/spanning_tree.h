// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Makes `root` the root of its spanning tree by turning round the chain of parents from it to the old root, as
// ORB-SLAM3 does when it merges maps. The root's parent is then none, and no keyframe of the chain waits for a parent
// any more. Map::first_keyframe and the like stay as they are. Does nothing when `root` is not in the map or already a
// root. A cycle that the chain runs into is cut where it closes.
void RerootTree(Map& map, KeyFrameId root);

// Hangs everything on the root, Map::first_keyframe, which must be in the map. Orphans are keyframes whose parent is
// none, themselves or not in the map, and the keyframe of the lowest id of each cycle. Each gets a parent that is in
// the tree and brings along what hangs on itself: of all pairs of an orphan and a keyframe of the tree that it is
// covisible with, the one with the greatest weight first, as ORB-SLAM3's KeyFrame::SetBadFlag does; orphans without one
// hang on the keyframe of the tree that was made last before them, or on the root. Children are made to agree with
// parents. Returns how many keyframes got another parent; a sound tree stays as it is. O(E log E) in the covisibility
// edges of the orphans, and linear in the map.
std::size_t AdoptOrphans(Map& map);

}  // namespace slamdb::detail
