// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/align_all.h"
#include "slamdb/align/join_aligned.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/export.h"

namespace slamdb {

// Standard deviations of an alignment, given the maps as they are.
struct AlignmentPrecision {
  double rotation_degrees = 0;  // about the axis about which it is least known
  double translation = 0;       // likewise, of the middle of what both maps see; first map's units
  double scale = 0;             // as a share of it; 0 where the scale is not free
};
[[nodiscard]] SLAMDB_EXPORT AlignmentPrecision PrecisionOf(const Alignment& alignment);

// What reports call a map.
struct MapName {
  std::string input;
  MapId map;
};

// As schema/merge.schema.json describes it, with `links` and `joins`. `names` by row of JoinAlignedReport::maps.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MergeReport& merged, const JoinAlignedReport& joined,
                                               const std::vector<MapName>& names, const std::string& output);

// A store that was searched for maps to align with.
struct SearchedStore {
  std::string path;
  std::vector<std::string> unlike;   // atlases in which nothing looks alike
  std::vector<std::string> unknown;  // of which it is not known what they look like
};

// As schema/align.schema.json describes it. `names` by row of the list of maps.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AlignedMaps& aligned, const std::vector<MapName>& names,
                                               const std::optional<SearchedStore>& store = {});

}  // namespace slamdb
