// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/g2o/detail/similarity_log.h"

#include <Eigen/LU>
#include <cmath>

#include "slamdb/model/detail/rotations.h"

namespace slamdb::g2o {
namespace {

// W of t = W u: the integral of exp(x (sigma + omega^)) for x from 0 to 1.
Eigen::Matrix3d Integral(const Eigen::Vector3d& omega, double sigma) {
  constexpr double kSmall = 1e-5;
  const double theta = omega.norm(), scale = std::exp(sigma);
  const double c = std::abs(sigma) < kSmall ? 1 + sigma / 2 : (scale - 1) / sigma;
  double a = 0, b = 0;  // of omega^ and its square
  if (theta < kSmall) {
    const bool still = std::abs(sigma) < kSmall;
    a = still ? 0.5 : ((sigma - 1) * scale + 1) / (sigma * sigma);
    b = still ? 1.0 / 6 : (scale * (sigma * sigma / 2 - sigma + 1) - 1) / (sigma * sigma * sigma);
  } else {
    const double sine = scale * std::sin(theta), cosine = scale * std::cos(theta);
    const double square = sigma * sigma + theta * theta;
    a = (sine * sigma + (1 - cosine) * theta) / (theta * square);
    b = (c - ((cosine - 1) * sigma + sine * theta) / square) / (theta * theta);
  }
  const Eigen::Matrix3d hat = detail::Hat(omega);
  return a * hat + b * hat * hat + c * Eigen::Matrix3d::Identity();
}

}  // namespace

Vector7d LogOf(const Similarity3d& similarity) {
  const Eigen::Vector3d omega = detail::AxisAngleOf(similarity.rotation);
  const double sigma = std::log(similarity.scale);
  Vector7d logarithm;
  logarithm << omega, Integral(omega, sigma).partialPivLu().solve(similarity.translation), sigma;
  return logarithm;
}

Similarity3d ExpOf(const Vector7d& logarithm) {
  const Eigen::Vector3d omega = logarithm.head<3>();
  const double sigma = logarithm[6];
  return {std::exp(sigma), detail::Turn(omega), Integral(omega, sigma) * logarithm.segment<3>(3)};
}

}  // namespace slamdb::g2o
