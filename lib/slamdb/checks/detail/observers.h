// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {

// Who observes what in a map: the observations of its good points by keyframes that it has, as rows, by point and by
// keyframe. By keyframe, what rules look up of an observation lies close together; by point it lies all over memory.
class Observers {
 public:
  struct Sight {
    std::uint32_t point;  // row
    std::int32_t left, right;
  };

  // Linear. `index` must outlive it.
  Observers(const AtlasIndex& index, std::size_t map_row);

  // Rows of keyframes, in the order of the point's observations.
  std::span<const std::uint32_t> Of(std::uint32_t point) const {
    return {observers_.data() + point_begins_[point], observers_.data() + point_begins_[point + 1]};
  }
  // In the order of the points.
  std::span<const Sight> By(std::uint32_t keyframe) const {
    return {sights_.data() + keyframe_begins_[keyframe], sights_.data() + keyframe_begins_[keyframe + 1]};
  }
  MapPointId IdOf(std::uint32_t point) const { return ids_[point]; }
  // What MapPoint::observation_count of a good point should be; observers that are missing do not count, as ORB-SLAM3
  // never counts them.
  std::int64_t CountOf(std::uint32_t point) const { return counts_[point]; }

 private:
  void ListObservers(const AtlasIndex& index, std::size_t map_row);
  void ListSights(const AtlasIndex& index, std::size_t map_row);

  std::vector<std::uint64_t> point_begins_, keyframe_begins_;  // of the lists, and the end of the last
  std::vector<std::uint32_t> observers_;
  std::vector<Sight> sights_;
  std::vector<MapPointId> ids_;
  std::vector<std::int64_t> counts_;
};

}  // namespace slamdb::detail
