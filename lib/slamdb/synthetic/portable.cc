// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/portable.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace slamdb::synthetic {
namespace {

// Taylor series of sine and cosine, exact to the last bits for |x| <= pi / 4.
double SmallSine(double x) {
  double term = x, sum = x;
  for (int i = 1; i <= 9; ++i) sum += term *= -x * x / (2.0 * i * (2.0 * i + 1));
  return sum;
}

double SmallCosine(double x) {
  double term = 1, sum = 1;
  for (int i = 1; i <= 9; ++i) sum += term *= -x * x / (2.0 * i * (2.0 * i - 1));
  return sum;
}

// The sine of `angle` plus `quarters` right angles.
double SineAhead(double angle, std::int64_t quarters) {
  const double nearest = std::floor(angle / (kPi / 2) + 0.5);
  const double rest = angle - nearest * (kPi / 2);
  switch ((static_cast<std::int64_t>(nearest) + quarters) & 3) {
    case 0:
      return SmallSine(rest);
    case 1:
      return SmallCosine(rest);
    case 2:
      return -SmallSine(rest);
    default:
      return -SmallCosine(rest);
  }
}

// Halves the angle until the series converges fast.
double PositiveArcTangent(double x) {
  double scale = 1;
  while (x > 0.125) {
    x = x / (1 + std::sqrt(1 + x * x));
    scale *= 2;
  }
  double power = x, sum = x;
  for (int i = 3; i <= 19; i += 2) sum += (power *= -x * x) / i;
  return scale * sum;
}

Quaternionf ToQuaternion(const Eigen::Matrix3d& r) {
  // Shepperd's method (J. Guidance and Control, 1978): the largest component first.
  const std::array<double, 4> squares = {1 + r(0, 0) + r(1, 1) + r(2, 2), 1 + r(0, 0) - r(1, 1) - r(2, 2),
                                         1 - r(0, 0) + r(1, 1) - r(2, 2), 1 - r(0, 0) - r(1, 1) + r(2, 2)};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (squares[i] > squares[largest]) largest = i;
  const double a = std::sqrt(squares[largest]) / 2, b = 1 / (4 * a);
  const double wx = (r(2, 1) - r(1, 2)) * b, wy = (r(0, 2) - r(2, 0)) * b, wz = (r(1, 0) - r(0, 1)) * b;
  const double xy = (r(0, 1) + r(1, 0)) * b, xz = (r(0, 2) + r(2, 0)) * b, yz = (r(1, 2) + r(2, 1)) * b;
  const std::array<std::array<double, 4>, 4> candidates = {
      {{a, wx, wy, wz}, {wx, a, xy, xz}, {wy, xy, a, yz}, {wz, xz, yz, a}}};
  std::array<float, 4> q;
  for (std::size_t i = 0; i < 4; ++i) {
    const double value = candidates[largest][i];
    q[i] = static_cast<float>(candidates[largest][0] < 0 ? -value : value);
  }
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

double Sine(double angle) { return SineAhead(angle, 0); }
double Cosine(double angle) { return SineAhead(angle, 1); }

double ArcTangent(double y, double x) {
  if (y < 0) return -ArcTangent(-y, x);
  if (x < 0) return kPi - ArcTangent(y, -x);
  return y > x ? kPi / 2 - PositiveArcTangent(x / y) : x == 0 ? 0 : PositiveArcTangent(y / x);
}

double Dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double Norm(const Eigen::Vector3d& a) { return std::sqrt(Dot(a, a)); }

Eigen::Matrix3d Hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d hat;
  hat << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return hat;
}

Eigen::Matrix3d Rotation(const Eigen::Vector3d& axis_angle) {
  const double angle = Norm(axis_angle);
  const Eigen::Matrix3d hat = Hat(axis_angle);
  const Eigen::Matrix3d square = Product(hat, hat);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() + hat + square * 0.5;
  return Eigen::Matrix3d::Identity() + hat * (Sine(angle) / angle) + square * ((1 - Cosine(angle)) / (angle * angle));
}

Eigen::Vector3d AxisAngle(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d twice_sine_axis(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  const double sine = Norm(twice_sine_axis) / 2;
  if (sine < 1e-10) return twice_sine_axis * 0.5;
  return twice_sine_axis * (ArcTangent(sine, (r(0, 0) + r(1, 1) + r(2, 2) - 1) / 2) / (2 * sine));
}

Pose Pose::Inverse() const {
  const Eigen::Matrix3d inverse = rotation.transpose();
  return {inverse, -Product(inverse, translation)};
}

Rigid3f Pose::Recorded() const { return {ToQuaternion(rotation), translation.cast<float>()}; }

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {Product(a_from_b.rotation, b_from_c.rotation), a_from_b * b_from_c.translation};
}

Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& x_in_b) {
  return Product(a_from_b.rotation, x_in_b) + a_from_b.translation;
}

}  // namespace slamdb::synthetic
