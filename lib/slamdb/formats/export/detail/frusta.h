// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "slamdb/model/keyframe.h"

namespace slamdb::detail {

// A camera as pictures of maps show it: its centre, and the corners of its image at a distance in front of it.
struct Frustum {
  // Of `vertices`: the four edges from the centre, then the four of the image.
  static constexpr std::array<std::array<std::uint16_t, 2>, 8> kEdges = {
      {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {2, 3}, {3, 4}, {4, 1}}};

  // The centre; the corners upper left, upper right, lower right, lower left. In the camera frame.
  std::array<Eigen::Vector3f, 5> vertices;

  friend bool operator<(const Frustum& a, const Frustum& b);
};

// By the intrinsics and bounds of the undistorted image; one of 4:3 and 67 degrees where those are none.
Frustum FrustumOf(const KeyFrame& keyframe, float depth);

// How deep to draw frusta: half of the median way from one camera to the next, so that they hardly touch. 0.1 where
// there is no such way. The centres stand in the order of time.
float FrustumDepth(std::span<const Eigen::Vector3f> centers);

}  // namespace slamdb::detail
