// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/stella/detail/stella_map.h"

namespace slamdb::stella {

// Takes out what refers to nothing, or stands twice, as stella_vslam does or would fail of, and says so: links to
// keyframes and points that are not there, points that no keyframe sees.
void CleanLinks(StoredMap& map, Notices& notices);

// Which part of the map each keyframe is in, from 0 on, by its lowest keyframe; and each point, by the keyframes that
// see it. Expects links that were cleaned, and keyframes by id.
struct Parts {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> of_keyframe, of_point;
};
Parts PartsOf(const StoredMap& map);

}  // namespace slamdb::stella
