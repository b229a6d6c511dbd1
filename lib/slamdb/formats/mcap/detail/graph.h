// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/colors.h"

namespace slamdb::detail {

// Lines between points: all of one kind.
struct GraphLines {
  std::string_view name;  // `covisibility`
  Color color{};
  double opacity = 1;
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> ends;  // rows of `points`, two a line
};

// The cameras, the path from one to the next, and the edges between keyframes: covisibility, spanning tree, loops,
// merges; each edge once, whichever sides record it. Kinds without lines are left out.
std::vector<GraphLines> GraphOf(const KeyFrameTrajectory& trajectory);

// Pairs of keyframes that have an edge, of which one has no pose among these.
std::size_t CountEdgesOutside(const KeyFrameTrajectory& trajectory);

}  // namespace slamdb::detail
