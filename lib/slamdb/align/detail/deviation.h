// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace slamdb::detail {

// The standard deviation along the axis along which three numbers of a covariance, from `begin` on, are least known.
template <int kSize>
double LargestDeviation(const Eigen::Matrix<double, kSize, kSize>& covariance, int begin) {
  const Eigen::Matrix3d block = covariance.template block<3, 3>(begin, begin);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

}  // namespace slamdb::detail
