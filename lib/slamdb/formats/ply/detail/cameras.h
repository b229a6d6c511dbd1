// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/colors.h"

namespace slamdb::detail {

// One row of the element `vertex`: a point, or part of a camera.
struct PlyVertex {
  Eigen::Vector3f position, normal;
  Color color{};
  float min_distance = 0, max_distance = 0;
  std::uint32_t observations = 0;
  float error = std::numeric_limits<float>::quiet_NaN();
  std::uint64_t map = 0, id = 0;
  std::uint8_t camera = 0;  // 0: a point; 1: a camera's centre; 2: a corner of its image
};

// The keyframes of an atlas as vertices and edges behind those of its points: five vertices each, a centre and four
// corners, in the order of time. Refers to the atlas.
class PlyCameras {
 public:
  static constexpr std::size_t kVertices = 5;  // of a keyframe
  using Edge = std::array<std::uint32_t, 2>;   // rows of `vertex`

  PlyCameras() = default;  // none
  // `first` is the row of the first vertex.
  PlyCameras(const Trajectories& trajectories, std::size_t first);

  std::size_t size() const { return cameras_.size(); }  // keyframes
  std::array<PlyVertex, kVertices> operator[](std::size_t camera) const;

  // Frusta, and the path from one centre to the next of its map.
  const std::vector<Edge>& edges() const { return edges_; }
  // Of the map that it is in.
  Color ColorOf(const Edge& edge) const;

  IdColumn ColumnForIds() const;

 private:
  struct Camera {
    const Map* map;
    const TimedPose* pose;
    float depth;
  };

  std::size_t first_ = 0;
  std::vector<Camera> cameras_;
  std::vector<Edge> edges_;
};

}  // namespace slamdb::detail
