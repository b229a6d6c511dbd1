// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slamdb::cli {

// A path seen from above, drawn with the dots of braille letters, two wide and four high, and in a line how long and
// wide it is. Empty when fewer than two places are finite, or all are one.
//
// `width` are the columns that it may take, `height` the lines.
std::string PlanText(const std::vector<Eigen::Vector2d>& path, const std::string& unit, std::size_t width,
                     std::size_t height);

}  // namespace slamdb::cli
