// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

enum class MapOrder {
  kAsIs,
  kSize,  // most keyframes first
  kTime,  // earliest keyframe first
  kId,    // lowest id first
};

struct FragmentOptions {
  std::size_t min_keyframes = 1;       // maps with fewer go; 1: only empty ones
  std::optional<std::size_t> largest;  // of the others, only so many with most keyframes stay
  MapOrder order = MapOrder::kAsIs;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
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
  std::vector<MapId> order;    // of the maps that are left
  SubsetReport removed;
};

// Drops maps that are empty or small, and orders the list of maps.
// Ids stay: ORB-SLAM3 sorts its maps by id, whatever their order in the file.
// Maps of landmarks alone are no fragments.
//
// Throws Error (kNotPossible), before anything changes, when no map would be left.
// Cost: linear, in place.
SLAMDB_EXPORT FragmentReport DropFragments(Atlas& atlas, const FragmentOptions& options = {});

// As schema/fragments.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const FragmentReport& report, const ReportFiles& files = {});

}  // namespace slamdb
