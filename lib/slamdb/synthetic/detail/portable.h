// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/model/rigid.h"

// Mathematics with the same bits on every machine: only the operations that IEEE 754 rounds exactly (+ - * / sqrt), in
// a fixed order. The functions of <cmath> differ between C libraries, and Eigen's products between instruction sets.
// All are pure.
namespace slamdb::synthetic {

inline constexpr double kPi = 3.14159265358979323846;

double Sine(double angle);  // radians, |angle| up to some thousands
double Cosine(double angle);
double ArcTangent(double y, double x);  // as std::atan2, for finite arguments

double Dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
double Norm(const Eigen::Vector3d& a);

// a * b, summing in ascending order.
template <int kRows, int kInner, int kColumns>
Eigen::Matrix<double, kRows, kColumns> Product(const Eigen::Matrix<double, kRows, kInner>& a,
                                               const Eigen::Matrix<double, kInner, kColumns>& b) {
  Eigen::Matrix<double, kRows, kColumns> product;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      double sum = 0;
      for (int i = 0; i < kInner; ++i) sum += a(row, i) * b(i, column);
      product(row, column) = sum;
    }
  }
  return product;
}

Eigen::Matrix3d Hat(const Eigen::Vector3d& a);  // Hat(a) * b = a x b

// The rotation by |axis_angle| radians about its direction, and back (angles below pi).
Eigen::Matrix3d Rotation(const Eigen::Vector3d& axis_angle);
Eigen::Vector3d AxisAngle(const Eigen::Matrix3d& rotation);

// Named target_from_source, as Rigid3f.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Pose Inverse() const;
  Rigid3f Recorded() const;
};
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);
Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& x_in_b);

}  // namespace slamdb::synthetic
