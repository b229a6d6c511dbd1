// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"

namespace slamdb {

struct ShrinkOptions {
  std::size_t target_keyframes = 0;            // at most so many; 0: any number
  std::uint64_t target_bytes = 0;              // of a binary .osa file; 0: any size
  bool for_localization = false;               // the preset, see Shrink
  std::size_t min_points = kPointsToLocalize;  // for a place to be covered, see Coverage
};

struct ShrinkReport {
  std::uint64_t bytes_before = 0, bytes_after = 0;  // of a binary .osa file, to 1 kB
  std::uint64_t features_dropped = 0, measurements_dropped = 0;
  SubsetReport removed;
  Coverage coverage;
};

// Makes an atlas small and keeps as many places as it can (Coverage). Keyframes are chosen by greedy maximum coverage:
// the next is the one that gives most to places that are not covered yet, then the one with most new points; gains only
// fall while choosing, so each is computed anew only when its keyframe comes first (lazy greedy; Minoux 1978), and the
// result is within 1 - 1/e of the best choice of as many keyframes. The rest goes with KeepSubset, at the strict
// border.
//
// for_localization: the map with most keyframes alone; features that see no point go (DropFreeFeatures), and the
// measurements behind inertial preintegrations, which ORB-SLAM3 only needs to cull keyframes and to initialise the IMU.
// What it reads when it loads and localises stays: grids, bags of words, covisibility, preintegrated motion.
//
// In place. Near linear. Throws Error when nothing is asked for, or not even one keyframe fits; the atlas is then of no
// use.
ShrinkReport Shrink(Atlas& atlas, const ShrinkOptions& options, int threads = 0);

}  // namespace slamdb
