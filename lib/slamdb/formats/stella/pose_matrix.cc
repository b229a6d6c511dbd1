// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/pose_matrix.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "slamdb/model/detail/is_pose.h"

namespace slamdb::stella {
namespace {

Eigen::Matrix3d MatrixOf(const Eigen::Vector4f& xyzw) {
  return Eigen::Quaterniond(xyzw.cast<double>()).toRotationMatrix();
}

// The products of a quaternion's numbers stand in its matrix, whatever its length: 1 + m00 - m11 - m22 = 4xx,
// m10 + m01 = 4xy, m21 - m12 = 4wx. Divided by the largest of x, y and z they give all of it.
Eigen::Vector4d ByLargest(const Eigen::Matrix3d& m, int largest, double square) {
  const int next = (largest + 1) % 3, last = (largest + 2) % 3;
  const double scale = 1 / (4 * std::sqrt(square));
  Eigen::Vector4d xyzw;
  xyzw[largest] = std::sqrt(square);
  xyzw[next] = (m(largest, next) + m(next, largest)) * scale;
  xyzw[last] = (m(largest, last) + m(last, largest)) * scale;
  xyzw[3] = (m(last, next) - m(next, last)) * scale;
  return xyzw;
}

// Of a rotation by nearly nothing: w is about 1, and the matrix knows no more of it than what the others then are.
Eigen::Vector4d ByReal(const Eigen::Matrix3d& m, double w) {
  return Eigen::Vector4d(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1), 4 * w * w) / (4 * w);
}

// The one in single precision whose matrix it is, if there is one.
Eigen::Vector4f QuaternionOf(const Eigen::Matrix3d& m) {
  constexpr double kSmall = 1e-6;
  constexpr int kUlps = 3;  // by which the length of one in single precision is off
  const Eigen::Vector3d squares = (1 + 2 * m.diagonal().array() - m.trace()) / 4;
  int largest = 0;
  const double square = squares.maxCoeff(&largest);
  if (square > kSmall) {
    const Eigen::Vector4d xyzw = ByLargest(m, largest, square);
    const Eigen::Vector4f exact = xyzw.cast<float>();
    return MatrixOf(exact) == m ? exact : Eigen::Vector4f(xyzw.normalized().cast<float>());
  }
  const auto unit = static_cast<float>(std::sqrt(std::max(0.0, 1 - squares.sum())));
  float below = unit, above = unit;
  for (int ulp = 0; ulp <= kUlps; ++ulp) {
    for (const float w : {below, above})
      if (const Eigen::Vector4f exact = ByReal(m, static_cast<double>(w)).cast<float>(); MatrixOf(exact) == m)
        return exact;
    below = std::nextafter(below, 0.0F);
    above = std::nextafter(above, 2.0F);
  }
  return ByReal(m, static_cast<double>(unit)).normalized().cast<float>();
}

}  // namespace

Eigen::Matrix4d PoseMatrix(const Rigid3f& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const bool is_unit = detail::IsUnit(pose.rotation);
  matrix.topLeftCorner<3, 3>() = MatrixOf((is_unit ? pose : pose.Normalized()).rotation.coeffs());
  matrix.topRightCorner<3, 1>() = pose.translation.cast<double>();
  return matrix;
}

Rigid3f PoseOf(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::Vector4f xyzw = QuaternionOf(rotation);
  Rigid3f pose;
  pose.rotation.coeffs() = xyzw.w() < 0 ? Eigen::Vector4f(-xyzw) : xyzw;
  pose.translation = matrix.topRightCorner<3, 1>().cast<float>();
  return pose;
}

}  // namespace slamdb::stella
