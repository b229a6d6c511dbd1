// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

// Places on a page. Units: pixels of CSS, from the upper left corner.
namespace slamdb::plot {

using Spot = Eigen::Vector2d;
using Spots = std::vector<Spot>;

struct Box {
  double left = 0, top = 0, width = 0, height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
  Spot center() const { return {left + width / 2, top + height / 2}; }
  bool Has(const Spot& spot) const {
    return spot.x() >= left && spot.x() <= right() && spot.y() >= top && spot.y() <= bottom();
  }
  // Without a margin at each side.
  Box Without(double at_left, double at_top, double at_right, double at_bottom) const {
    return {left + at_left, top + at_top, width - at_left - at_right, height - at_top - at_bottom};
  }
};

}  // namespace slamdb::plot
