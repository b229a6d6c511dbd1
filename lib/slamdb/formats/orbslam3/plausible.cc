// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/plausible.h"

#include <algorithm>

#include "slamdb/model/detail/is_pose.h"

namespace slamdb::orbslam3 {

std::vector<const KeyFrame*> ById(const Map& map) {
  std::vector<const KeyFrame*> by_id;
  by_id.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) by_id.push_back(&keyframe);
  std::ranges::sort(by_id, {}, [](const KeyFrame* keyframe) { return keyframe->id; });
  return by_id;
}

bool IsTime(double seconds) { return seconds == 0 || (seconds >= 1e-6 && seconds < 1e11); }

bool IsTimeBehind(double last, double seconds) {
  constexpr double kLongestGap = 3600;
  return IsTime(seconds) && seconds >= last && seconds - last < kLongestGap;
}

std::uint64_t CountImplausible(const Atlas& atlas) {
  std::uint64_t count = 0;
  for (const Map& map : atlas.maps) {
    const KeyFrame* last = nullptr;
    for (const KeyFrame* keyframe : ById(map)) {
      const double time = keyframe->timestamp;
      const bool is_time = last == nullptr ? IsTime(time) : IsTimeBehind(last->timestamp, time);
      count += !is_time || !slamdb::detail::IsUnit(keyframe->camera_from_world.rotation);
      last = keyframe;
    }
  }
  return count;
}

bool LooksLikeAnotherLayout(const Atlas& atlas, std::uint64_t implausible) {
  std::uint64_t keyframes = 0;
  for (const Map& map : atlas.maps) keyframes += map.keyframes.size();
  return 2 * implausible > keyframes;
}

}  // namespace slamdb::orbslam3
