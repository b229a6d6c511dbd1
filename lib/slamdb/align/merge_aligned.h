// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/join_aligned.h"
#include "slamdb/align/optimize_joined.h"
#include "slamdb/align/report_json.h"
#include "slamdb/base/notices.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/export.h"

namespace slamdb {

// What is moved, behind the join, so that pictures of both maps fit.
enum class Tightening {
  kUsual,  // kSeam, or nothing where slamdb was built without Ceres
  kNone,
  kPoseGraph,
  kSeam,
  kFull,
};

struct MergeAlignedOptions {
  MergeOptions merge;                               // its names, too: of all inputs; `join` is not used
  std::optional<FuseOptions> fuse = FuseOptions{};  // as in JoinAlignedOptions
  Tightening tightening = Tightening::kUsual;
};

struct MergeAlignedResult {
  MergeResult merged;
  std::vector<MapName> names;  // of the maps with keyframes, as they were
  std::vector<bool> metric;    // of these: before they were joined
  JoinAlignedReport joined;
  std::vector<OptimizedJoin> tightened;

  bool any() const { return !joined.joins.empty(); }  // otherwise the result is of no use
};

// MergeAtlases, and then one map of those that overlap: JoinAlignedMaps, and OptimizeJoined behind it. Id maps follow.
// Says which maps stay apart, and what does not go together.
//
// Throws Error as these. kNotPossible: there is only one map with keyframes.
[[nodiscard]] SLAMDB_EXPORT MergeAlignedResult MergeAligned(std::vector<Atlas> inputs,
                                                            const MergeAlignedOptions& options, Notices& notices);

[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MergeAlignedResult& result, const std::string& output = {});

}  // namespace slamdb
