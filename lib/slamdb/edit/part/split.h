// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

enum class SplitBy {
  kMap,
  kSession,    // the map in which keyframes were made, which they keep when maps are merged
  kComponent,  // connected part of the covisibility graph
};

struct SplitOptions {
  SplitBy by = SplitBy::kMap;
  Border border = Border::kSmart;  // for points that several parts observe
  std::size_t min_keyframes = 1;   // parts with fewer are left out, but for maps of landmarks alone
  int threads = 0;                 // 0: every core
  Progress progress;               // may be empty
};

// One part of an atlas that is split: `map-3`, `session-0`, `map-3-component-2`.
struct Part {
  std::string name;
  Subset subset;
};

// The parts in order of map, session or component (by size within its map), with their borders settled.
// Maps without keyframes are none, unless they hold landmarks and are parts as a whole.
// Points belong to every part that observes them, landmarks to every part of their map.
//
// Throws Error (kNotPossible) when no part is left.
// Cost: linear for each part.
[[nodiscard]] SLAMDB_EXPORT std::vector<Part> SplitAtlas(const AtlasIndex& index, const SplitOptions& options = {});

// KeepSubset of a copy. Maps without a keyframe or landmark in the subset are not copied.
//
// Throws Error (kUsage) when the subset is not of this atlas.
// Cost: linear in the part. `threads` 0: every core.
[[nodiscard]] SLAMDB_EXPORT Atlas TakePart(const Atlas& atlas, const Subset& subset, SubsetReport& report,
                                           int threads = 0);

// A part that was taken, for the report.
struct TakenPart {
  std::string name;
  std::string output;  // where it is; empty: it was not written
  EntityCounts counts;
};

// As schema/split.schema.json describes it. `files.output` is left out: each part has its own.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const TakenPart> parts, const ReportFiles& files = {});

}  // namespace slamdb
