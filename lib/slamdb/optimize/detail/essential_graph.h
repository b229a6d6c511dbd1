// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/optimize/pose_graph.h"

namespace slamdb::detail {

// How one keyframe lies to another, and how surely. Shifts are in units of the first keyframe's lengths.
struct PoseEdge {
  std::uint32_t first, second;  // rows
  Similarity3d first_from_second;
  Eigen::Matrix<double, 7, 7> root_information;  // of turn, shift, log scale
};

// The edges of a map with their measurements from its states: constraints first, in their order.
// Counts them in the report. `depth`: the length by which shifts are measured.
// Throws Error as OptimizePoseGraph.
std::vector<PoseEdge> EssentialGraph(const Map& map, const MapStates& states, const PoseGraphOptions& options,
                                     double depth, PoseGraphReport& report);

// The median distance of points from the camera of their reference keyframe; 1 where there is none.
double MedianDepth(const Map& map, const MapStates& states);

}  // namespace slamdb::detail
