// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/pose_graph.h"

namespace slamdb {

enum class OptimizeMethod {
  kPoseGraph,  // the constraints alone
  kSeam,       // bundle adjustment of the keyframes at a seam
  kFull,       // of all
};

// `pose-graph`, `seam`, `full`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(OptimizeMethod method);

struct OptimizeOptions {
  OptimizeMethod method = OptimizeMethod::kFull;
  std::vector<MapId> maps;                  // none: every map with keyframes
  std::vector<PoseConstraint> constraints;  // the pose graph comes first where there are any; each is of one map
  std::vector<KeyFrameId> seam;             // SeamKeyFrames around these; none: around those with merge or loop edges
  bool fix_poses = false, fix_points = false;  // of bundle adjustment
  std::optional<int> iterations;               // at most, in each step; none: 50
  int threads = 0;                             // 0: every core; the result is the same for any number
  Progress progress;                           // may be empty
};

struct MapOptimization {
  MapId map;
  std::optional<PoseGraphReport> pose_graph;
  std::optional<BundleReport> bundle;  // none for the method pose-graph, and where there is no seam
};

struct OptimizeReport {
  OptimizeMethod method = OptimizeMethod::kFull;
  std::vector<MapOptimization> maps;
};

// Optimises maps one after the other: OptimizePoseGraph, then AdjustBundle.
//
// Throws Error as these two. kNotFound: a constraint is of keyframes that no chosen map has both of. kUsage: the pose
// graph alone without a constraint, or with poses or points fixed.
// What fails before the first map changes nothing.
SLAMDB_EXPORT OptimizeReport OptimizeMaps(Atlas& atlas, const OptimizeOptions& options = {});

// As schema/optimize.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const OptimizeReport& report, const ReportFiles& files = {});

}  // namespace slamdb
