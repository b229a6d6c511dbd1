// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// How origin map ids change: the id of the map in which a keyframe or a point was made, which stays when maps are
// merged. Points whose origin is not recorded stay so. Applied in the order of the fields.
struct OriginOptions {
  bool from_map = false;             // the id of the map that the keyframe or point is in now
  std::optional<std::uint32_t> set;  // this one, for all
  std::vector<std::pair<std::uint32_t, std::uint32_t>> replace;  // {from, to}, all at once
  std::int64_t shift = 0;                                        // added
  bool compact = false;                                          // 0, 1, 2, ... in the order of the ids
};

struct OriginReport {
  std::map<std::uint32_t, std::uint64_t> before, after;                // keyframes by origin map id
  std::map<std::uint32_t, std::uint64_t> points_before, points_after;  // points whose origin is recorded
  std::uint64_t changed = 0, points_changed = 0;                       // keyframes, points
  std::uint64_t next_map_before = 0, next_map_after = 0;               // the counter, which stays above every origin
};

// Changes the origin map ids of all keyframes, and of the points that have one.
//
// Throws Error, and then changes nothing:
//   kUsage        `replace` names an origin twice, or swaps origins in a circle
//   kNotPossible  `replace` names an origin that nothing has, or an id leaves [0, 2^32 - 1)
// Cost: linear.
SLAMDB_EXPORT OriginReport ReassignOrigins(Atlas& atlas, const OriginOptions& options = {});

// As schema/reassign-origin.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const OriginReport& report, const ReportFiles& files = {});

}  // namespace slamdb
