// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/known_map.h"

namespace slamdb::detail {

KnownMap::KnownMap(const MapViews& map, std::uint32_t without) : map_(map), without_(without) {
  if (without == kNoRow) return;
  const std::uint32_t last = map.LastViewOf(without);
  has_pair_ = last != without;
  for (std::uint32_t view = without; view <= last; ++view)
    for (const Seen& seen : map.SeenBy(view)) {
      const Descriptor* other = nullptr;
      std::uint32_t keyframe = kNoRow;  // of the first other sighting
      bool two = false;
      for (const Sighting& sighting : map.SightingsOf(seen.point)) {
        if (LeavesOut(sighting.view)) continue;
        const View& from = map.views()[sighting.view];
        if (other == nullptr) other = &from.descriptors[sighting.keypoint];
        two = two || (keyframe != kNoRow && keyframe != from.keyframe);
        keyframe = from.keyframe;
      }
      if (!two) {
        changed_[seen.point] = nullptr;
      } else if (map.views()[view].descriptors[seen.keypoint] == *map.points()[seen.point].descriptor) {
        changed_[seen.point] = other;
      }
    }
}

}  // namespace slamdb::detail
