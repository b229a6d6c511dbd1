// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/align/align_all.h"

namespace slamdb::detail {

// What is known of each of the maps that links are between.
struct MapTraits {
  bool metric = false;
  double median_depth = 0;
};

// Brings maps into one frame by their links, the surest of which come first, and sets what use each link is.
// Where links contradict each other, one of them is wrong, and nothing says which: the maps that they meet at stay
// alone. Deterministic.
std::vector<MapPlace> GroupMaps(std::vector<MapLink>& links, const std::vector<MapTraits>& maps);

}  // namespace slamdb::detail
