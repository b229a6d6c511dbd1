// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

// Rotations and their small changes, in double. After Forster et al., TRO 2017, equations 3 to 8.
namespace slamdb::detail {

inline constexpr double kSmallAngle = 1e-5;  // radians; below, the first terms of the series are exact enough

// The matrix of the cross product: Hat(a) * b = a x b.
inline Eigen::Matrix3d Hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d hat;
  hat << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return hat;
}

// The rotation about an axis by its length, radians.
inline Eigen::Quaterniond Turn(const Eigen::Vector3d& axis_angle) {
  const double angle = axis_angle.norm();
  if (angle < kSmallAngle)
    return Eigen::Quaterniond(1, axis_angle.x() / 2, axis_angle.y() / 2, axis_angle.z() / 2).normalized();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_angle / angle));
}

// The axis and angle of a rotation, at most pi.
inline Eigen::Vector3d AxisAngleOf(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm(), cosine = rotation.w();
  if (sine < kSmallAngle) return (cosine < 0 ? -2 : 2) * rotation.vec();
  const double half = cosine < 0 ? std::atan2(-sine, -cosine) : std::atan2(sine, cosine);
  return 2 * half / sine * rotation.vec();
}

// How a small change of an axis and angle turns the rotation, seen from its source.
inline Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& axis_angle) {
  const double angle = axis_angle.norm();
  const Eigen::Matrix3d hat = Hat(axis_angle);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() - hat / 2;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() - hat * ((1 - std::cos(angle)) / square) +
         hat * hat * ((angle - std::sin(angle)) / (square * angle));
}

// And the inverse, for angles below pi.
inline Eigen::Matrix3d InverseRightJacobian(const Eigen::Vector3d& axis_angle) {
  const double angle = axis_angle.norm();
  const Eigen::Matrix3d hat = Hat(axis_angle);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + hat / 2;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + hat / 2 +
         hat * hat * (1 / square - (1 + std::cos(angle)) / (2 * angle * std::sin(angle)));
}

}  // namespace slamdb::detail
