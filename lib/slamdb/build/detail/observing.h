// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

// New observations, each held against the keyframes of a map and those before it. The map stays as it is.
class Observing {
 public:
  // What arguments are called.
  struct Names {
    std::string_view point, keyframe, keypoint;
  };

  Observing(const Map& map, const Names& names) : map_(map), names_(names), keyframes_(KeyFrameTable(map)) {}

  // Adds to the observations of point `point` that it is that keypoint. `point` and `row` are what errors tell.
  // Throws Error (kUsage).
  void Add(std::uint64_t point, KeyFrameId keyframe, std::uint64_t keypoint, std::size_t row,
           Column<Observation>& observations);

  std::uint32_t RowOf(KeyFrameId keyframe) const { return keyframes_.Find(keyframe.value()); }

 private:
  const Features& FeaturesOf(KeyFrameId keyframe, std::size_t row) const;

  const Map& map_;
  const Names names_;
  const IdTable keyframes_;
  std::set<std::pair<KeyFrameId, std::uint64_t>> taken_;  // keypoints
};

// What follows for the graph when the keyframes at `rows` see other points than before: their covisibility, parents of
// those that shared none before, and of fisheye pairs the matches that points tell.
void UpdateGraph(Map& map, const std::vector<std::uint32_t>& rows);

}  // namespace slamdb::detail
