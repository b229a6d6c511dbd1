// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/part_sizes.h"

#include <array>

namespace slamdb::orbslam3 {

void ListPartSizes(const PartBytes& bytes, std::size_t file_bytes, std::vector<PartSize>& sizes) {
  constexpr std::array<const char*, static_cast<std::size_t>(Part::kCount)> kNames{
      "keyframes", "keypoints", "stereo and depth", "descriptors", "bags of words", "matches",
      "grids",     "graph",     "inertial",         "map points",  "observations",  "other"};
  std::uint64_t known = 0;
  for (std::size_t i = 0; i + 1 < kNames.size(); ++i) {
    sizes.push_back({kNames[i], bytes[i]});
    known += bytes[i];
  }
  sizes.push_back({kNames.back(), file_bytes - known});
}

void Select(const Selection& selection, Atlas& atlas) {
  if (selection.map) std::erase_if(atlas.maps, [&](const Map& map) { return map.id != *selection.map; });
  for (Map& map : atlas.maps) {
    std::erase_if(map.keyframes, [&](const KeyFrame& keyframe) { return !selection.Has(keyframe); });
    std::erase_if(map.points, [&](const MapPoint& point) { return !selection.Has(point); });
    map.repeated_keyframes.clear();
    map.repeated_points.clear();
  }
  atlas.repeated_maps.clear();
}

}  // namespace slamdb::orbslam3
