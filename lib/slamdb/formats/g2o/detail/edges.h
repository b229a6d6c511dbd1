// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::g2o {

// An edge of the essential graph: rows of keyframes of a map, the lower id first.
struct Edge {
  std::uint32_t first, second;
  std::int32_t weight = 0;  // shared points as covisibility has them; 0: not recorded
};

// A good keyframe whose pose is finite.
bool IsVertex(const KeyFrame& keyframe);

struct EssentialGraph {
  std::vector<Edge> edges;  // each pair once, by ids
  std::size_t outside = 0;  // pairs of which one is no vertex, or is not in the map
};

// Spanning tree, loops, merges, and covisibility from 100 points on, as ORB-SLAM3 optimises it.
EssentialGraph EssentialGraphOf(const Map& map);

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// How surely reprojection of the points that both of two keyframes see tells how the second lies to the first.
// Refers to the atlas.
//
// Constant after construction: safe to use from many threads.
class SharedViews {
 public:
  SharedViews(const Atlas& atlas, const Map& map);

  // The Fisher information of a small motion of the second camera in its own frame: shift, turn (radians). Each camera
  // is as sure as its own pixels make it, points given; what the first one is not sure of, the second one is not
  // either. Noise is a pixel at octave 0. nullopt where the points do not tell all six.
  std::optional<Matrix6d> InformationOf(std::uint32_t first, std::uint32_t second) const;

 private:
  struct Sight {
    std::uint32_t point;  // row
    std::uint32_t keypoint;
    friend auto operator<=>(const Sight&, const Sight&) = default;
  };
  struct View {
    const KeyFrame* keyframe = nullptr;
    const Camera* camera = nullptr;
    Eigen::Matrix3d rotation;  // camera from world
    Eigen::Vector3d translation;
    std::vector<Sight> sights;  // by point
  };
  void Add(const View& view, const Sight& sight, Matrix6d& information) const;

  const Map& map_;
  std::vector<View> views_;  // by row of the keyframes
};

}  // namespace slamdb::g2o
