// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/align_all.h"
#include "slamdb/base/progress.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct JoinAlignedOptions {
  std::optional<FuseOptions> fuse =
      FuseOptions{};  // points that were matched, and others at one place; none: keep them apart
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

struct JoinAlignedReport {
  AlignedMaps aligned;                             // links and places are by row of `maps`
  std::vector<MapId> maps;                         // with keyframes, as they were
  std::vector<std::vector<KeyFrameId>> keyframes;  // of each of these
  std::vector<JoinReport> joins;                   // one for each map that went into another
  std::vector<MapId> apart;                        // maps that link to nothing, and stay as they are
};

// Aligns all maps of an atlas and makes one map of those that are linked.
// Each group is joined into its first map that an IMU keeps upright, or else its first metric one, or its first: its
// frame stays.
// Points that were matched are fused, and others that lie at one place; each verified link of two maps gives merge
// edges.
//
// Throws Error as JoinMaps; what fails before the first join changes nothing.
// Cost: AlignAllMaps, then linear.
SLAMDB_EXPORT JoinAlignedReport JoinAlignedMaps(Atlas& atlas, const AlignOptions& align = {},
                                                const JoinAlignedOptions& options = {});

}  // namespace slamdb
