// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// The good keyframes of a map that have a finite time, in its order.
inline std::vector<const KeyFrame*> GoodByTime(const Map& map) {
  std::vector<const KeyFrame*> by_time;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.bad && std::isfinite(keyframe.timestamp)) by_time.push_back(&keyframe);
  std::ranges::stable_sort(by_time, {}, [](const KeyFrame* keyframe) { return keyframe->timestamp; });
  return by_time;
}

}  // namespace slamdb::detail
