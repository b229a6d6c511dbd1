// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/align/join_aligned.h"
#include "slamdb/base/progress.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/optimize/optimize.h"

namespace slamdb {

struct OptimizeJoinedOptions {
  OptimizeMethod method = OptimizeMethod::kSeam;
  int threads = 0;    // 0: every core; the result is the same for any number
  Progress progress;  // may be empty
};

// One round of tightening a joined map.
struct OptimizedJoin {
  std::uint64_t observations = 0;  // added, of points that pictures of another session show
  FuseReport fused;                // points that these pictures show to be one
  MapOptimization optimization;    // what moved then; its figures before are behind what was added and fused
};

// Tightens what JoinAlignedMaps joined, which only laid each map beside the other as a whole: every picture is searched
// for points of the other sessions, which it sees from then on, or which are fused with those that it sees there; then
//   kPoseGraph  the map was bent before that, along its essential graph, to how the verified pairs of keyframes lie
//   kSeam       bundle adjustment of the keyframes about the verified pairs
//   kFull       bundle adjustment of all; search and adjustment once more, as more is found where maps fit better
// Maps that were not joined stay as they are.
//
// Throws Error (kUnsupported) where this slamdb was built without Ceres, and then changes nothing.
// Cost: the search is linear in pictures and the points before each; then that of OptimizeMaps.
// After the welding of maps in ORB-SLAM3 (Campos et al., TRO 2021).
SLAMDB_EXPORT std::vector<OptimizedJoin> OptimizeJoined(Atlas& atlas, const JoinAlignedReport& joined,
                                                        const OptimizeJoinedOptions& options = {});

}  // namespace slamdb
