// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/subset.h"

namespace slamdb {

enum class MapOrder {
  kAsIs,
  kSize,  // most keyframes first
  kTime,  // earliest keyframe first
  kId,    // lowest id first
};

struct FragmentOptions {
  std::size_t min_keyframes = 1;  // maps with fewer go; 1: only empty ones
  std::size_t largest = 0;        // of the others, so many with most keyframes stay; 0: all
  MapOrder order = MapOrder::kAsIs;
};

// One map of the atlas as it was.
struct Fragment {
  MapId id;
  std::uint64_t keyframes = 0, points = 0;
  double begin_time = 0, end_time = 0;  // seconds; 0 when it has no keyframes
  bool kept = false;
};

struct FragmentReport {
  std::vector<Fragment> maps;  // in the order they had
  SubsetReport removed;
};

// Drops maps that are empty or small, and orders the list of maps. Ids stay: ORB-SLAM3 sorts its maps by id, whatever
// their order in the file. In place; linear. Throws Error, before anything changes, when no map would be left.
FragmentReport DropFragments(Atlas& atlas, const FragmentOptions& options, int threads = 0);

}  // namespace slamdb
