// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

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
  std::size_t min_keyframes = 1;  // parts with fewer are left out, but for maps of landmarks alone
};

// One part of an atlas that is split: `map-3`, `session-0`, `map-3-component-2`.
struct Part {
  struct OfMap {
    std::uint32_t map = 0;                 // row of Atlas::maps
    std::vector<std::uint32_t> keyframes;  // rows, ascending
    std::vector<std::uint32_t> points;     // rows of those that these keyframes observe, ascending
  };
  std::string name;
  std::vector<OfMap> maps;  // those that it has something of, ascending
  EntityCounts of_atlas;    // how many there are in all
};

// The parts in order of map, session or component (by size within its map).
// Maps without keyframes are none, unless they hold landmarks and are parts as a whole.
//
// Throws Error (kNotPossible) when no part is left.
// Cost: linear in the atlas, time and memory, however many parts there are.
[[nodiscard]] SLAMDB_EXPORT std::vector<Part> SplitAtlas(const AtlasIndex& index, const SplitOptions& options = {});

// An atlas of the part alone: its keyframes, the points that they observe, as far as the border lets them stay, and all
// landmarks of their maps; closed as KeepSubset does it.
//
// Throws Error (kUsage) when the part is not of this atlas.
// Cost: copies what the part holds alone, and the keyframes between its own in time; one pass over flags of the rows of
// its maps. `threads` 0: every core.
[[nodiscard]] SLAMDB_EXPORT Atlas TakePart(const AtlasIndex& index, const Part& part, Border border,
                                           SubsetReport& report, int threads = 0);

// A part that was taken, for the report.
struct TakenPart {
  std::string name;
  std::string output;  // where it is; empty: it was not written
  EntityCounts counts;
};

// As schema/split.schema.json describes it. `files.output` is left out: each part has its own.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const TakenPart> parts, const ReportFiles& files = {});

}  // namespace slamdb
