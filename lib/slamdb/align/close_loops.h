// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/align/loops.h"
#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/optimize/optimize.h"

namespace slamdb {

struct CloseLoopsOptions {
  std::vector<MapId> maps;      // none: every map with keyframes
  bool adjust_bundle = true;    // behind the pose graph, of the whole map
  bool own_vocabulary = false;  // as in AlignOptions
  int threads = 0;              // 0: every core; the result is the same for any number
  Progress progress;            // may be empty
};

// What was found in a map, and what was done about it.
struct ClosedMap {
  MapId map;
  LoopSearch search;
  // Of maps with a missed loop alone:
  std::uint64_t constraints = 0;  // pairs of keyframes that the pose graph was bent to; each became a loop edge
  FuseReport fused;               // points of both ends
  MapOptimization optimization;   // pose graph, and bundle adjustment where it was wanted
};

struct CloseLoopsReport {
  std::vector<ClosedMap> maps;
  std::uint64_t closed = 0;  // loops
};

// Finds the loops that were missed in maps (FindLoops), and closes those that are sure, in place:
//   the map is bent along its essential graph until both ends lie as their pictures say (OptimizePoseGraph)
//   a few of the pairs that agree become loop edges of both keyframes, which are not to be erased
//   points that are the same thing are fused, those of the earlier end survive, and covisibility is counted anew
//   the whole map is adjusted (AdjustBundle), if wanted
// and the map's count of big changes goes up. Null pointers and repetitions in lists go. An atlas without missed loops
// keeps its bytes.
//
// Throws Error before anything is changed:
//   kUnsupported  there is a loop to close, and this slamdb was built without Ceres
//   kNotFound     the atlas has no such map
// Cost: FindLoops and a pose graph; bundle adjustment takes many times that.
// After ORB-SLAM3's loop correction (Campos et al., TRO 2021).
SLAMDB_EXPORT CloseLoopsReport CloseLoops(Atlas& atlas, const CloseLoopsOptions& options = {});

// As schema/close-loops.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const CloseLoopsReport& report, const ReportFiles& files = {});

}  // namespace slamdb
