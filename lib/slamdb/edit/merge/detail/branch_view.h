// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "slamdb/edit/merge/detail/branch_structure.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

// One of the three maps of a merge, for look-up while another one changes.
namespace slamdb::detail {

// Who sees what in one map: keypoints by their points' classes, and whether these say so, too.
class Sightings {
 public:
  Sightings() = default;
  Sightings(const Map& map, const PointClasses& classes, const IdTable& keyframes) {
    slots_.reserve(map.keyframes.size());
    listed_.resize(map.keyframes.size());
    for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
      const Column<MapPointId>& points = map.keyframes[row].features.map_points;
      std::vector<MapPointId>& slots = slots_.emplace_back(points.begin(), points.end());
      for (MapPointId& slot : slots) slot = classes.Of(slot);
      listed_[row].assign(slots.size(), 0);
    }
    for (const MapPoint& point : map.points)
      for (const Observation& observation : point.observations) {
        const std::uint32_t row = keyframes.Find(observation.keyframe.value());
        for (const std::int32_t slot : {observation.left, observation.right})
          if (row != kNoRow && Sees(map.keyframes[row], slot, point.id))
            listed_[row][static_cast<std::size_t>(slot)] = 1;
      }
  }

  static bool Sees(const KeyFrame& keyframe, std::int32_t slot, MapPointId point) {
    const Column<MapPointId>& points = keyframe.features.map_points;
    return slot >= 0 && static_cast<std::size_t>(slot) < points.size() &&
           points[static_cast<std::size_t>(slot)] == point;
  }

  const std::vector<MapPointId>& Of(std::uint32_t row) const { return slots_[row]; }
  MapPointId Of(std::uint32_t row, std::size_t slot) const {
    return row != kNoRow && slot < slots_[row].size() ? slots_[row][slot] : MapPointId();
  }
  bool IsListed(std::uint32_t row, std::size_t slot) const {
    return row != kNoRow && slot < listed_[row].size() && listed_[row][slot] != 0;
  }

 private:
  std::vector<std::vector<MapPointId>> slots_;  // by row of the keyframes
  std::vector<std::vector<std::uint8_t>> listed_;
};

// One of the three maps, for look-up.
struct View {
  const Map* map = nullptr;
  IdTable keyframes, points;
  Sightings sightings;

  View() = default;
  View(const Map& of, const PointClasses& classes)
      : map(&of), keyframes(KeyFrameTable(of)), points(PointTable(of)), sightings(of, classes, keyframes) {}

  std::uint32_t Row(KeyFrameId id) const { return keyframes.Find(id.value()); }
  const KeyFrame* Find(KeyFrameId id) const {
    const std::uint32_t row = Row(id);
    return row == kNoRow ? nullptr : &map->keyframes[row];
  }
  const MapPoint* Find(MapPointId id) const {
    const std::uint32_t row = points.Find(id.value());
    return row == kNoRow ? nullptr : &map->points[row];
  }
};

}  // namespace slamdb::detail
