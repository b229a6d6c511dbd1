// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/pose_numbers.h"

#include <Eigen/LU>
#include <limits>

namespace slamdb::detail {
namespace {

constexpr double kMost = std::numeric_limits<float>::max();

}  // namespace

// By its length, which no rotation changes: in the camera's frame it is to be finite as well.
const char* WhyNoPosition(const Eigen::Vector3d& position) {
  return position.norm() <= kMost ? nullptr : "a position that is not finite, or beyond what a 32-bit float holds";
}

const char* WhyNoPose(const Eigen::Vector4d& quaternion, const Eigen::Vector3d& position) {
  constexpr double kLeast = 1e-6;
  const double length = quaternion.norm();
  if (length <= kLeast) return "a quaternion of length 0";
  return length <= kMost ? WhyNoPosition(position)
                         : "a quaternion that is not finite, or beyond what a 32-bit float holds";
}

const char* WhyNoPoseOfMatrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  constexpr double kTolerance = 0.01;
  const bool turns = rotation.isUnitary(kTolerance) && rotation.determinant() > 0;
  return turns ? WhyNoPosition(position) : "a matrix that is no rotation";
}

}  // namespace slamdb::detail
