// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

// What pictures show of a map: by row of a keyframe, rows of points that a picture taken there finds.
using PointsShown = std::vector<std::vector<std::uint32_t>>;

// Who looks at an atlas that something of must be chosen. ShrinkForLocating (slamdb/align) does.
struct ShrinkLooks {
  // Before the choice: what pictures show beside what keyframes have recorded. By row of Atlas::maps. May be empty.
  std::function<std::vector<PointsShown>(const Atlas&)> before;
  // At what was chosen, while its keyframes still have all their features. May be empty.
  std::function<void(const Atlas&)> after;
};

// At least one of the first four must be asked for.
struct ShrinkOptions {
  std::optional<std::size_t> target_keyframes;  // at most so many
  std::optional<std::uint64_t> target_bytes;    // at most so many of a binary .osa file
  bool for_localization = false;                // the preset, see Shrink
  bool largest_map = false;                     // only the map with most keyframes stays, whatever else is asked for
  bool for_mapping = false;                     // what the preset takes stays, however few bytes are asked for
  std::size_t min_points = kPointsToLocalize;   // with which a camera is found, and a place covered (Coverage)
  ShrinkLooks looks;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

// Keyframes of the input, each of them located by its own features as if the map had never had it (Locator).
struct PlacesFound {
  std::uint64_t places = 0, before = 0, after = 0;  // found in the input, and in the result
};

struct ShrinkReport {
  std::uint64_t bytes_before = 0, bytes_after = 0;  // of a binary .osa file, to 1 kB
  std::uint64_t features_dropped = 0, measurements_dropped = 0;
  SubsetReport removed;
  Coverage coverage;
  std::optional<PlacesFound> found;  // where someone looked, see ShrinkForLocating
};

// Makes an atlas small so that a camera is found in it from as many places as can be.
// Bytes: what the preset takes goes first, all of it, and then points that no other place shows, of keyframes that show
// enough others, unless the atlas is for mapping; then keyframes.
// Keyframes go one by one, next the one without which finding loses least, for each byte where bytes are asked for. A
// place is found by one keyframe: the one, of those that are tried, that has most points which the place shows. Tried
// are those that have nearly as many words in common with it as any has, so that keyframes which stand in the way of
// others with their many words go early, and even where the target is met. After ORB-SLAM3's relocalisation.
// Points go with the keyframes that they need: a point that loses observers needs two, or one with depth.
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
//   kUsage        nothing is asked for, or both purposes; before anything changes
//   kNotPossible  not even one keyframe fits, or there is no map or no good keyframe; the atlas is then of no use
// Cost: in place, about the keyframes times their neighbours: 0.05 s for 60 keyframes, 1 s for 1,000; the result is the
// same for any number of threads.
SLAMDB_EXPORT ShrinkReport Shrink(Atlas& atlas, const ShrinkOptions& options = {});

// As schema/shrink.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ShrinkReport& report, const ReportFiles& files = {});

}  // namespace slamdb
