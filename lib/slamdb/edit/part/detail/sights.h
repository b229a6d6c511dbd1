// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {

// Who sees what in all maps of an atlas, under numbers that run through the maps in the order of their lists. Keyframes
// and points that are flagged bad see and are seen by nobody. Constant after construction.
class Sights {
 public:
  // One of a keyframe and a point that it observes. The weight is what the observation adds to the point's count.
  struct Sight {
    std::uint32_t number;
    std::uint32_t weight;
  };

  // Linear in the observations. `index` must outlive it.
  explicit Sights(const AtlasIndex& index);

  std::size_t keyframes() const { return rows_.size(); }
  std::size_t points() const { return needs_.size(); }
  const Atlas& atlas() const { return *atlas_; }

  std::span<const Sight> PointsOf(std::uint32_t keyframe) const {
    return {by_keyframe_.data() + keyframe_begins_[keyframe], by_keyframe_.data() + keyframe_begins_[keyframe + 1]};
  }
  std::span<const Sight> ObserversOf(std::uint32_t point) const {
    return {by_point_.data() + point_begins_[point], by_point_.data() + point_begins_[point + 1]};
  }
  // What the observations by kept keyframes must weigh for the point to stay at the strict border (SettleBorder).
  std::uint32_t Need(std::uint32_t point) const { return needs_[point]; }

  const EntityRow& RowOf(std::uint32_t keyframe) const { return rows_[keyframe]; }
  const KeyFrame& KeyFrameOf(std::uint32_t keyframe) const {
    return atlas_->maps[rows_[keyframe].map].keyframes[rows_[keyframe].row];
  }
  std::uint32_t FirstPoint(std::size_t map) const { return first_point_[map]; }

  // Good keyframes, map by map, ascending by id: as they were made.
  std::vector<std::uint32_t> InOrder() const;

 private:
  void ListObservers(const AtlasIndex& index, std::size_t map, std::uint32_t first_keyframe);
  void ListPoints();

  const Atlas* atlas_;
  std::vector<EntityRow> rows_;             // of keyframes
  std::vector<std::uint32_t> first_point_;  // of maps
  std::vector<std::uint32_t> needs_;        // of points
  std::vector<std::size_t> keyframe_begins_, point_begins_;
  std::vector<Sight> by_keyframe_, by_point_;
};

}  // namespace slamdb::detail
