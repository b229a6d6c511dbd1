// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/optimize/detail/inertial_links.h"
#include "slamdb/optimize/detail/measurements.h"

// What Ceres minimises, with analytic derivatives. The block of a pose has seven numbers and six degrees of freedom;
// its derivatives are by the six, in the first columns, and the manifold passes them on.
namespace slamdb::detail {

// A pose moves by a turn and a shift of the points in its camera's frame: x_c' = Turn(w) x_c + v.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

// The reprojection error of a measurement by pose and point, in standard deviations. Behind the camera it is a large
// constant, so that no step ends there that a smaller one would not.
template <int kRows>
class ReprojectionCost final : public ceres::SizedCostFunction<kRows, 7, 3> {
 public:
  explicit ReprojectionCost(const Measurement& measurement) : measurement_(&measurement) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  const Measurement* measurement_;
};

// How two keyframes in a row disagree with what the IMU measured between them: rotation, velocity, position, in
// standard deviations. Blocks: pose, velocity and bias of the first, pose and velocity of the second. Forster et al.,
// TRO 2017, equation 45, with the bias corrected to first order (equation 44).
class InertialCost final : public ceres::SizedCostFunction<9, 7, 3, 6, 7, 3> {
 public:
  explicit InertialCost(const InertialLink& link) : link_(&link) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  const InertialLink* link_;
};

// The random walk of the biases between two keyframes, in standard deviations.
class BiasWalkCost final : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  explicit BiasWalkCost(const InertialLink& link) : link_(&link) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  const InertialLink* link_;
};

}  // namespace slamdb::detail
