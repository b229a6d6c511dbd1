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
  MapOptimization optimization;    // the pose graph before that, of the first round alone, and the bundle behind it
};

// Tightens what JoinAlignedMaps joined, which only laid each map beside the other as a whole:
//   the map is bent, along the essential graph of each session, to how the verified pairs of keyframes lie
//   every picture is searched for points of the other sessions: it sees them from then on, or they are fused with those
//   that it sees there
//   kPoseGraph  that is all
//   kSeam       the bundle of the keyframes about the verified pairs is adjusted
//   kFull       that of all is; search and adjustment come once more, as more is found where maps fit better
// Maps that were not joined stay as they are.
//
// Throws Error (kUnsupported) where this slamdb was built without Ceres, and then changes nothing.
// Cost: the search is linear in pictures and the points before each; then that of OptimizeMaps.
// After the welding of maps in ORB-SLAM3 (Campos et al., TRO 2021).
SLAMDB_EXPORT std::vector<OptimizedJoin> OptimizeJoined(Atlas& atlas, const JoinAlignedReport& joined,
                                                        const OptimizeJoinedOptions& options = {});

}  // namespace slamdb
