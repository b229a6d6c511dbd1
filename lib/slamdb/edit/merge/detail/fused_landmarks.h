// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/merge/fuse.h"

namespace slamdb::detail {

// Landmarks that stand for points which went into others stand for these.
void FollowFusedPoints(const FuseReport& fused, Map& map);

}  // namespace slamdb::detail
