// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/covisibility.h"

#include <algorithm>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::int32_t kSharedPointsOfEdge = 15;

void SetConnection(KeyFrame& keyframe, KeyFrameId other, std::int32_t weight) {
  const auto place = std::ranges::lower_bound(keyframe.connections, other, {}, &Connection::keyframe);
  if (place != keyframe.connections.end() && place->keyframe == other)
    place->weight = weight;
  else
    keyframe.connections.insert(place, {other, weight});
}

class Updater {
 public:
  explicit Updater(Map& map)
      : map_(map), keyframes_(KeyFrameTable(map)), points_(PointTable(map)), shared_(map.keyframes.size(), 0) {}

  void Update(std::uint32_t row) {
    Count(row);
    if (others_.empty()) return;
    std::ranges::sort(others_, {}, [&](std::uint32_t other) { return map_.keyframes[other].id; });
    KeyFrame& keyframe = map_.keyframes[row];
    keyframe.connections.clear();
    std::uint32_t most = others_.front();
    bool linked = false;
    for (const std::uint32_t other : others_) {
      keyframe.connections.push_back({map_.keyframes[other].id, shared_[other]});
      if (shared_[other] > shared_[most]) most = other;
      if (shared_[other] < kSharedPointsOfEdge) continue;
      SetConnection(map_.keyframes[other], keyframe.id, shared_[other]);
      linked = true;
    }
    if (!linked) SetConnection(map_.keyframes[most], keyframe.id, shared_[most]);
    for (const std::uint32_t other : others_) shared_[other] = 0;
  }

 private:
  // How many points each other keyframe shares with this one.
  void Count(std::uint32_t row) {
    others_.clear();
    for (const MapPointId id : map_.keyframes[row].features.map_points) {
      const std::uint32_t point = points_.Find(id.value());
      if (point == kNoRow || map_.points[point].bad) continue;
      for (const Observation& observation : map_.points[point].observations) {
        const std::uint32_t other = keyframes_.Find(observation.keyframe.value());
        if (other == kNoRow || other == row || map_.keyframes[other].bad) continue;
        if (shared_[other]++ == 0) others_.push_back(other);
      }
    }
  }

  Map& map_;
  const IdTable keyframes_, points_;
  std::vector<std::int32_t> shared_;  // by row; all 0 between updates
  std::vector<std::uint32_t> others_;
};

}  // namespace

void UpdateCovisibility(Map& map, std::span<const std::uint32_t> rows) {
  Updater updater(map);
  for (const std::uint32_t row : rows) updater.Update(row);
}

}  // namespace slamdb::detail
