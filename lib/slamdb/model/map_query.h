// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// What a map is looked for by: where, when, and which keyframes. What is flagged bad does not count.
struct MapQuery {
  struct Times {
    double begin = 0, end = 0;  // seconds, both included; one moment: twice the same
  };
  struct Ids {
    std::uint64_t first = 0, last = 0;  // both included
  };
  struct Ball {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // world
    double radius = 0;                                 // metres or map units
  };
  std::optional<Times> times;    // lie, in part, between the first and the last keyframe of the map
  std::optional<Ids> keyframes;  // the map has one of them
  std::optional<Ball> near;      // the map has a point, or a landmark, in it

  bool everything() const { return !times && !keyframes && !near; }
};

// Whether the map has all that is asked for.
//
// Cost: linear. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT bool Matches(const Map& map, const MapQuery& query);
// Whether one map of the atlas does. Every atlas does when nothing is asked for.
[[nodiscard]] SLAMDB_EXPORT bool Matches(const Atlas& atlas, const MapQuery& query);

}  // namespace slamdb
