// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/pose_matrix.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace slamdb::stella {
namespace {

Eigen::Matrix3d MatrixOf(const Eigen::Vector4f& xyzw) {
  return Eigen::Quaterniond(xyzw.cast<double>()).toRotationMatrix();
}

// A quaternion of single precision is of unit length up to its last bit: of those a bit away, the one that the matrix
// was made of.
Eigen::Vector4f NearestExact(const Eigen::Vector4f& xyzw, const Eigen::Matrix3d& rotation) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int combination = 0; combination < 81; ++combination) {
    Eigen::Vector4f tried = xyzw;
    for (int i = 0, rest = combination; i < 4; ++i, rest /= 3) {
      if (rest % 3 == 1) tried[i] = std::nextafter(tried[i], kInfinity);
      if (rest % 3 == 2) tried[i] = std::nextafter(tried[i], -kInfinity);
    }
    if (MatrixOf(tried) == rotation) return tried;
  }
  return xyzw;
}

}  // namespace

Eigen::Matrix4d PoseMatrix(const Rigid3f& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = MatrixOf(pose.rotation.coeffs());
  matrix.topRightCorner<3, 1>() = pose.translation.cast<double>();
  return matrix;
}

Rigid3f PoseOf(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  Eigen::Quaterniond quaternion(rotation);
  quaternion.normalize();
  Eigen::Vector4f xyzw = quaternion.coeffs().cast<float>();
  for (int i = 0; i < 4; ++i)
    if (std::abs(xyzw[i]) < 1e-15F) xyzw[i] = 0;  // what is left of a difference of equal numbers
  Rigid3f pose;
  pose.rotation.coeffs() = NearestExact(xyzw, rotation);
  pose.translation = matrix.topRightCorner<3, 1>().cast<float>();
  return pose;
}

}  // namespace slamdb::stella
