// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/subset.h"

namespace slamdb::detail {

struct RedundancyRule {
  double share = 0.9;         // of its points, above which a keyframe is redundant
  int observers = 3;          // other keyframes that make a point redundant
  bool depth_counts = false;  // only points not beyond the depth threshold of the keyframe count
};

// Takes redundant keyframes of one map (a row of Atlas::maps) out of `rows`, by ascending id. See Cull in cull.h, which
// this is a part of. Returns how many.
std::uint64_t CullKeyFrames(const AtlasIndex& index, std::size_t map_row, const RedundancyRule& rule,
                            Subset::MapRows& rows);

}  // namespace slamdb::detail
