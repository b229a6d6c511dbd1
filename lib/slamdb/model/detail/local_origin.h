// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

// Coordinates of the world (ECEF, UTM), which the 32-bit floats of an atlas would round by half a metre.
namespace slamdb::detail {

// The median by axis, which places far off do not move: whole, so that it is easily added again. Zero of no places;
// they are finite.
Eigen::Vector3d WholeMiddleOf(const std::vector<Eigen::Vector3d>& places);

// What is to be taken off places that reach too far for floats: their middle. Zero where they may stay. What is not
// finite is not asked.
Eigen::Vector3d LocalOriginOf(std::vector<Eigen::Vector3d> places);

// `(499998, 5400001, 502)`: all digits.
std::string OriginText(const Eigen::Vector3d& origin);

}  // namespace slamdb::detail
