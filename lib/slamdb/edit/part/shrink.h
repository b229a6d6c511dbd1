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

// At least one of the first four must be asked for.
struct ShrinkOptions {
  std::optional<std::size_t> target_keyframes;  // at most so many
  std::optional<std::uint64_t> target_bytes;    // at most so many of a binary .osa file
  bool for_localization = false;                // the preset, see Shrink
  bool largest_map = false;                     // only the map with most keyframes stays, whatever else is asked for
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
// What a choice of keyframes covers is counted with the points that really stay: a point that loses observers needs two
// keyframes that see it, or one with depth.
// Keyframes are chosen greedily: next comes the one, or the two together, that give most to places that are not covered
// yet, then those with most new points.
// The choice never covers less than as many consecutive keyframes, or as many evenly spaced ones.
// Keyframes and points flagged bad go first.
// The rest goes with KeepSubset, at the strict border.
//
// for_localization:
//   features that see no point go (DropFreeFeatures)
//   measurements behind inertial preintegrations go, which ORB-SLAM3 only needs to cull keyframes and to initialise the
//   IMU
//   what it reads when it loads and localises stays: grids, bags of words, covisibility, preintegrated motion
//
// Throws Error:
//   kUsage        nothing is asked for; before anything changes
//   kNotPossible  not even one keyframe fits, or there is no map or no good keyframe; the atlas is then of no use
// Cost: near linear, in place; the result is the same for any number of threads.
SLAMDB_EXPORT ShrinkReport Shrink(Atlas& atlas, const ShrinkOptions& options = {});

// As schema/shrink.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ShrinkReport& report, const ReportFiles& files = {});

}  // namespace slamdb
