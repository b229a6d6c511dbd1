// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/align/detail/map_views.h"
#include "slamdb/edit/merge/observe.h"

namespace slamdb::detail {

// What pictures of one session show of what another one has mapped.
struct Across {
  std::vector<SeenPoint> seen;  // points at keypoints that are none yet, the most alike first
  // Points at keypoints that are another point, those that most pictures show so first; the lower row is the first.
  std::vector<std::pair<MapPointId, MapPointId>> same;
};

// Looks for points in pictures of other sessions than those that see them, where the map says that they are, by what
// any picture saw of them. `sessions`: by row of the map's keyframes. Deterministic for any number of threads.
Across FindAcross(const MapViews& map, std::span<const std::uint32_t> sessions, int threads);

}  // namespace slamdb::detail
