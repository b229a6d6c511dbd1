// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slamdb::detail {

// A corner of one level of the pyramid.
struct Corner {
  int x = 0, y = 0;  // pixels of the level
  float response = 0;
};

// Which of the corners are kept so that they are all over the picture: a quadtree is divided, the fullest leaves first,
// until it has `count` leaves or no leaf has two corners; of each leaf the strongest corner stays, the first of equals.
// Rows of `corners`, ascending.
//
// Requires: corners lie in [0, width) x [0, height).
// After the feature extraction of ORB-SLAM (Mur-Artal et al., TRO 2015).
std::vector<std::size_t> SpreadCorners(std::span<const Corner> corners, int width, int height, std::size_t count);

}  // namespace slamdb::detail
