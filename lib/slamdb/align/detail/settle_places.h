// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/align/detail/group_maps.h"

namespace slamdb::detail {

// Where links close cycles, what they disagree by is spread over all of them, each by its number of matched points.
// Metric maps of a group keep the scale that they have to each other.
// Deterministic. Cost: some sweeps, each of maps times links.
void SettlePlaces(const std::vector<MapLink>& links, const std::vector<MapTraits>& maps, std::vector<MapPlace>& places);

}  // namespace slamdb::detail
