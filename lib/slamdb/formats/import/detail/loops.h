// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Both keyframes of a loop have its edge.
inline void AddLoop(KeyFrame& one, KeyFrame& other) {
  one.loop_edges.push_back(other.id);
  other.loop_edges.push_back(one.id);
}

// Loop edges of each keyframe by id, each once.
void SortLoops(Column<KeyFrame>& keyframes);

}  // namespace slamdb::detail
