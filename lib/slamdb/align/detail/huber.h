// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

// Least squares of reprojections with Huber's loss, of a state that small motions of `Size` numbers change.
namespace slamdb::detail {

inline constexpr double kHuber = 5.99;  // squared; chi-square, two degrees of freedom, 95 %
inline constexpr double kFarOff = 1e6;  // squared error of a point behind the camera

// The normal equations of a state.
template <int Size>
struct RobustNormal {
  using Matrix = Eigen::Matrix<double, Size, Size>;
  using Vector = Eigen::Matrix<double, Size, 1>;

  Matrix hessian = Matrix::Zero();
  Vector gradient = Vector::Zero();
  double cost = 0;
  std::size_t residuals = 0;

  void Add(const Eigen::Vector2d& error, const Eigen::Matrix<double, 2, Size>& jacobian) {
    const double squared = error.squaredNorm(), root = std::sqrt(squared);
    const double weight = squared <= kHuber ? 1 : std::sqrt(kHuber) / root;
    cost += squared <= kHuber ? squared : 2 * std::sqrt(kHuber) * root - kHuber;
    residuals += 2;
    hessian.noalias() += weight * jacobian.transpose() * jacobian;
    gradient.noalias() += weight * jacobian.transpose() * error;
  }
  // A point behind the camera pulls nowhere, and costs much.
  void AddBehind() {
    cost += 2 * std::sqrt(kHuber * kFarOff) - kHuber;
    residuals += 2;
  }

  // The motion that solves them, in the span of the basis.
  Vector Step(const Eigen::MatrixXd& basis, double damping) const {
    Eigen::MatrixXd reduced = basis.transpose() * hessian * basis;
    reduced.diagonal() *= 1 + damping;
    return -(basis * reduced.ldlt().solve(basis.transpose() * gradient));
  }

  // Of the motion; zero where there is no residual to spare.
  Matrix Covariance(const Eigen::MatrixXd& basis) const {
    const Eigen::MatrixXd reduced = basis.transpose() * hessian * basis;
    const auto free = static_cast<double>(basis.cols()), count = static_cast<double>(residuals);
    if (!(count > free)) return Matrix::Zero();
    const double variance = std::max(1.0, cost / (count - free));
    return variance * (basis * reduced.ldlt().solve(Eigen::MatrixXd(basis.transpose())));
  }
};

// Levenberg-Marquardt. `linearise(state)` gives the normal equations, `moved(state, motion)` another state; motions are
// in the span of the basis. Changes the state to the best one, and returns its normal equations.
template <int Size, class State, class Linearise, class Moved>
RobustNormal<Size> MinimiseRobustly(State& state, int iterations, const Eigen::MatrixXd& basis,
                                    const Linearise& linearise, const Moved& moved) {
  double damping = 1e-4;
  RobustNormal<Size> normal = linearise(state);
  for (int i = 0; i < iterations && normal.residuals > 0; ++i) {
    const State next_state = moved(state, normal.Step(basis, damping));
    const RobustNormal<Size> next = linearise(next_state);
    if (!(next.cost < normal.cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = next.cost > normal.cost * (1 - 1e-7);
    state = next_state;
    normal = next;
    damping = std::max(damping / 10, 1e-12);
    if (settled) break;
  }
  return normal;
}

}  // namespace slamdb::detail
