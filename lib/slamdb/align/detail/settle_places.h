// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/align/align_all.h"

namespace slamdb::detail {

// Where links close cycles, what they disagree by is spread over all of them, each by its number of matched points.
// `metric`: by map; those of a group keep the scale that they have to each other.
// Deterministic. Cost: linear in the links.
void SettlePlaces(const std::vector<MapLink>& links, const std::vector<bool>& metric, std::vector<MapPlace>& places);

}  // namespace slamdb::detail
