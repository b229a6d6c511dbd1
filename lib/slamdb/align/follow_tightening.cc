// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/follow_tightening.h"

#include <algorithm>
#include <iterator>

#include "slamdb/edit/merge/merge.h"

namespace slamdb::detail {

std::vector<MapPointId> SortedPoints(const Atlas& atlas) {
  std::vector<MapPointId> points;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) points.push_back(point.id);
  std::ranges::sort(points);
  return points;
}

void FollowTightening(std::span<const OptimizedJoin> tightened, std::span<const MapPointId> before, const Atlas& atlas,
                      std::span<IdMap> id_maps) {
  std::vector<MapPointId> gone;
  std::ranges::set_difference(before, SortedPoints(atlas), std::back_inserter(gone));
  for (IdMap& ids : id_maps) {
    for (const OptimizedJoin& round : tightened) FollowFuse(round.fused, ids);
    FollowRemoval(gone, ids);
  }
}

}  // namespace slamdb::detail
