// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "slamdb/align/optimize_joined.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/model/atlas.h"

// Id maps of a merge whose result was tightened.
namespace slamdb::detail {

// The points of an atlas, ascending.
std::vector<MapPointId> SortedPoints(const Atlas& atlas);

// `before` are the SortedPoints that the atlas had: those that were fused since lead to the one that they are in, and
// those that are gone nowhere.
void FollowTightening(std::span<const OptimizedJoin> tightened, std::span<const MapPointId> before, const Atlas& atlas,
                      std::span<IdMap> id_maps);

}  // namespace slamdb::detail
