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

}  // namespace slamdb::orbslam3
