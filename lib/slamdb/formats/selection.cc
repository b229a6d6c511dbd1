// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/format.h"

namespace slamdb {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

bool Selection::everything() const { return !map && !has_keyframe_range() && !box; }

bool Selection::has_keyframe_range() const {
  return first_keyframe != 0 || last_keyframe != std::numeric_limits<std::uint64_t>::max() ||
         begin_time != -kInfinity || end_time != kInfinity;
}

bool Selection::Has(const KeyFrame& keyframe) const {
  const std::uint64_t id = keyframe.id.value();
  if (id < first_keyframe || id > last_keyframe) return false;
  if (begin_time == -kInfinity && end_time == kInfinity) return true;  // also for a time that is not a number
  return keyframe.timestamp >= begin_time && keyframe.timestamp <= end_time;
}

bool Selection::Has(const MapPoint& point) const { return !box || box->contains(point.position); }

void detail::Select(const Selection& selection, Atlas& atlas) {
  if (selection.everything()) return;
  if (selection.map) std::erase_if(atlas.maps, [&](const Map& map) { return map.id != *selection.map; });
  for (Map& map : atlas.maps) {
    std::erase_if(map.keyframes, [&](const KeyFrame& keyframe) { return !selection.Has(keyframe); });
    std::erase_if(map.points, [&](const MapPoint& point) { return !selection.Has(point); });
    map.repeated_keyframes.clear();
    map.repeated_points.clear();
  }
  atlas.repeated_maps.clear();
}

}  // namespace slamdb
