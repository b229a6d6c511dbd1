// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/detail/unit.h"

#include <algorithm>

namespace slamdb::detail {

bool HasStereo(const Map& map) {
  return std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) {
    return keyframe.right_camera || keyframe.intrinsics.baseline_fx > 0;
  });
}

}  // namespace slamdb::detail
