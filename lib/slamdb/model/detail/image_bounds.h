// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "slamdb/model/keyframe.h"

namespace slamdb::detail {

// Without their fraction; 0 for what is not finite.
inline std::int32_t WholePixels(double pixels) {
  constexpr double kMost = 1e6;
  return static_cast<std::int32_t>(std::isfinite(pixels) ? std::clamp(pixels, -kMost, kMost) : 0);
}

// The bounds of a picture as ORB-SLAM3 makes them: by its corners, each where `undistorted(pixel)` is, and by no other
// places of its sides. Without a grid.
template <class Undistort>
ImageBounds BoundsOfCorners(double width, double height, const Undistort& undistorted) {
  const Eigen::Vector2d upper_left = undistorted(Eigen::Vector2d(0, 0)),
                        upper_right = undistorted(Eigen::Vector2d(width, 0)),
                        lower_left = undistorted(Eigen::Vector2d(0, height)),
                        lower_right = undistorted(Eigen::Vector2d(width, height));
  return {.min_x = WholePixels(std::min(upper_left.x(), lower_left.x())),
          .min_y = WholePixels(std::min(upper_left.y(), upper_right.y())),
          .max_x = WholePixels(std::max(upper_right.x(), lower_right.x())),
          .max_y = WholePixels(std::max(lower_left.y(), lower_right.y()))};
}

// ORB-SLAM3's grid of 64 x 48 cells; of bounds that hold nothing, cells without a size.
inline void SetGrid(ImageBounds& bounds) {
  bounds.grid_columns = 64;
  bounds.grid_rows = 48;
  const std::int32_t width = bounds.max_x - bounds.min_x, height = bounds.max_y - bounds.min_y;
  bounds.inverse_cell_width = width > 0 ? 64 / static_cast<float>(width) : 0;
  bounds.inverse_cell_height = height > 0 ? 48 / static_cast<float>(height) : 0;
}

}  // namespace slamdb::detail
