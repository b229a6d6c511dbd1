// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/align_all.h"
#include "slamdb/align/join_aligned.h"
#include "slamdb/align/optimize_joined.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/export.h"

namespace slamdb {

// What reports call a map.
struct MapName {
  std::string input;
  MapId map;
};
[[nodiscard]] SLAMDB_EXPORT std::string NameText(const MapName& name);  // `a.osa map 0`

// As schema/merge.schema.json describes it, with `links`, `joins` and `optimizations`. `names` by row of
// JoinAlignedReport::maps.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MergeReport& merged, const JoinAlignedReport& joined,
                                               const std::vector<OptimizedJoin>& optimized,
                                               const std::vector<MapName>& names, const std::string& output);

// A store that was searched for maps to align with.
struct SearchedStore {
  std::string path;
  std::vector<std::string> unlike;       // atlases in which nothing looks alike
  std::vector<std::string> unknown;      // of which it is not known what they look like
  std::vector<std::string> unreachable;  // of a fleet, whose server does not answer
};

// As schema/align.schema.json describes it. `names` by row of the list of maps.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AlignedMaps& aligned, const std::vector<MapName>& names,
                                               const std::optional<SearchedStore>& store = {});

}  // namespace slamdb
