// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slamdb::detail {

// The standard deviation of places along the second longest axis of their ellipsoid.
template <int Size>
double SecondAxis(const std::vector<Eigen::Matrix<double, Size, 1>>& places) {
  const auto count = static_cast<double>(places.size());
  Eigen::Matrix<double, Size, 1> mean = Eigen::Matrix<double, Size, 1>::Zero();
  for (const auto& place : places) mean += place;
  mean /= count;
  Eigen::Matrix<double, Size, Size> spread = Eigen::Matrix<double, Size, Size>::Zero();
  for (const auto& place : places) spread += (place - mean) * (place - mean).transpose();
  spread /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>> solver(spread, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[Size - 2]));
}

}  // namespace slamdb::detail
