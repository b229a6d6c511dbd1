// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/counters.h"

#include <algorithm>

namespace slamdb {

Counters LeastCounters(const Atlas& atlas) {
  Counters least;
  const auto raise = [](std::uint64_t& counter, std::uint64_t id) {
    if (id != MapId::kNone) counter = std::max(counter, id + 1);
  };
  for (const Map& map : atlas.maps) {
    raise(least.map, map.id.value());
    for (const KeyFrame& keyframe : map.keyframes) {
      raise(least.keyframe, keyframe.id.value());
      raise(least.frame, keyframe.frame_id);
    }
    for (const MapPoint& point : map.points) raise(least.map_point, point.id.value());
    for (const Landmark& landmark : map.landmarks)
      if (landmark.is_numbered()) raise(least.map_point, landmark.id.value());
  }
  for (const Camera& camera : atlas.cameras) raise(least.camera, camera.id.value());
  return least;
}

std::size_t RaiseCounters(Atlas& atlas) {
  const Counters least = LeastCounters(atlas);
  std::size_t raised = 0;
  for (const auto counter :
       {&Counters::map, &Counters::frame, &Counters::keyframe, &Counters::map_point, &Counters::camera}) {
    if (atlas.next_ids.*counter >= least.*counter) continue;
    atlas.next_ids.*counter = least.*counter;
    ++raised;
  }
  return raised;
}

}  // namespace slamdb
