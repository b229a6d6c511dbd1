// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slamdb::cli {

// A path seen from above, drawn with the dots of braille letters, two wide and four high: with its bounds, the start
// marked, and how long the frame is. Empty when fewer than two places are finite. Of a path of a single place nothing.
//
// `width` are the columns that it may take, `height` the lines.
std::string PlanText(const std::vector<Eigen::Vector2d>& path, const std::string& unit, std::size_t width,
                     std::size_t height);

}  // namespace slamdb::cli
