// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

// At least one of the first three must be asked for.
struct ShrinkOptions {
  std::optional<std::size_t> target_keyframes;  // at most so many
  std::optional<std::uint64_t> target_bytes;    // at most so many of a binary .osa file
  bool for_localization = false;                // the preset, see Shrink
  std::size_t min_points = kPointsToLocalize;   // for a place to be covered, see Coverage
  int threads = 0;                              // 0: every core
  Progress progress;                            // may be empty
};

struct ShrinkReport {
  std::uint64_t bytes_before = 0, bytes_after = 0;  // of a binary .osa file, to 1 kB
  std::uint64_t features_dropped = 0, measurements_dropped = 0;
  SubsetReport removed;
  Coverage coverage;
};

// Makes an atlas small and keeps as many places as it can (Coverage).
// Keyframes are chosen by greedy maximum coverage: the next is the one that gives most to places that are not covered
// yet, then the one with most new points.
// Gains only fall while choosing, so each is computed anew only when its keyframe comes first (lazy greedy; Minoux
// 1978).
// The result is within 1 - 1/e of the best choice of as many keyframes.
// The rest goes with KeepSubset, at the strict border.
//
// for_localization:
//   the map with most keyframes alone stays
//   features that see no point go (DropFreeFeatures)
//   measurements behind inertial preintegrations go, which ORB-SLAM3 only needs to cull keyframes and to initialise the
//   IMU
//   what it reads when it loads and localises stays: grids, bags of words, covisibility, preintegrated motion
//
// Throws Error:
//   kUsage        nothing is asked for; before anything changes
//   kNotPossible  not even one keyframe fits, or there is no map; the atlas is then of no use
// Cost: near linear, in place; the result is the same for any number of threads.
SLAMDB_EXPORT ShrinkReport Shrink(Atlas& atlas, const ShrinkOptions& options = {});

// As schema/shrink.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ShrinkReport& report, const ReportFiles& files = {});

}  // namespace slamdb
