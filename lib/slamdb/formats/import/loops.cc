// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/loops.h"

#include <algorithm>

namespace slamdb::detail {

void SortLoops(Column<KeyFrame>& keyframes) {
  for (KeyFrame& keyframe : keyframes) {
    Column<KeyFrameId>& edges = keyframe.loop_edges;
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
}

}  // namespace slamdb::detail
