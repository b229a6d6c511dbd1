// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/costs.h"

#include "slamdb/model/detail/rotations.h"

namespace slamdb::detail {
namespace {

constexpr double kFarOff = 1e3;  // standard deviations, of a point behind the camera

template <int kRows, int kColumns>
using RowMajor = Eigen::Map<Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>>;
using ConstVector3 = Eigen::Map<const Eigen::Vector3d>;
using ConstRotation = Eigen::Map<const Eigen::Quaterniond>;

// By the seven numbers of a pose block, of which the first six count.
template <int kRows>
void SetByPose(const Eigen::Matrix<double, kRows, 6>& by_motion, double* jacobian) {
  RowMajor<kRows, 7> by_pose(jacobian);
  by_pose.template leftCols<6>() = by_motion;
  by_pose.col(6).setZero();
}

// The IMU of a keyframe in the world, and how it moves with the pose of the camera.
struct Body {
  Eigen::Matrix3d rotation;  // world_from_body
  Eigen::Vector3d position;
  Eigen::Matrix<double, 3, 6> turn_by_pose, position_by_pose;  // the turn as the body sees it

  Body(const double* pose, const Eigen::Matrix3d& camera_from_body, const Eigen::Vector3d& body_in_camera) {
    const Eigen::Matrix3d world_from_camera = ConstRotation(pose).toRotationMatrix().transpose();
    rotation = world_from_camera * camera_from_body;
    position = world_from_camera * (body_in_camera - ConstVector3(pose + 4));
    turn_by_pose << -camera_from_body.transpose(), Eigen::Matrix3d::Zero();
    position_by_pose << world_from_camera * Hat(body_in_camera), -world_from_camera;
  }
};

// The derivatives of rotation, velocity and position errors, by what they depend on.
struct InertialErrors {
  Eigen::Matrix<double, 9, 1> errors;
  Eigen::Matrix<double, 9, 3> by_first_turn, by_second_turn, by_first_position, by_velocity;
  Eigen::Matrix<double, 9, 6> by_bias;
  Eigen::Matrix3d first_from_world;

  InertialErrors(const InertialLink& link, const Body& first, const Body& second, double const* const* blocks) {
    const ConstVector3 velocity(blocks[1]), second_velocity(blocks[4]);
    const Eigen::Matrix<double, 6, 1> bias_change =
        Eigen::Map<const Eigen::Matrix<double, 6, 1>>(blocks[2]) - link.bias;
    const Eigen::Vector3d fall(0, 0, -kGravity * link.duration);
    first_from_world = first.rotation.transpose();
    const Eigen::Vector3d turned = link.rotation_by_gyro * bias_change.head<3>();
    const Eigen::Matrix3d measured = link.rotation * Turn(turned).toRotationMatrix();
    const Eigen::Matrix3d off = measured.transpose() * first_from_world * second.rotation;
    const Eigen::Vector3d gain = first_from_world * (second_velocity - velocity - fall);
    const Eigen::Vector3d way =
        first_from_world * (second.position - first.position - (velocity + fall / 2) * link.duration);
    const Eigen::Vector3d turn_error = AxisAngleOf(Eigen::Quaterniond(off));
    errors << turn_error, gain - link.velocity - link.velocity_by_bias * bias_change,
        way - link.position - link.position_by_bias * bias_change;
    const Eigen::Matrix3d by_turn = InverseRightJacobian(turn_error);
    by_first_turn << -by_turn * second.rotation.transpose() * first.rotation, Hat(gain), Hat(way);
    by_second_turn << by_turn, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero();
    by_first_position << Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), -first_from_world;
    by_velocity << Eigen::Matrix3d::Zero(), -first_from_world, -link.duration * first_from_world;
    by_bias.setZero();
    by_bias.topLeftCorner<3, 3>() = -by_turn * off.transpose() * RightJacobian(turned) * link.rotation_by_gyro;
    by_bias.middleRows<3>(3) = -link.velocity_by_bias;
    by_bias.bottomRows<3>() = -link.position_by_bias;
  }
};

}  // namespace

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond turn = Turn(ConstVector3(delta));
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta} = (turn * ConstRotation(x)).normalized();
  Eigen::Map<Eigen::Vector3d>{x_plus_delta + 4} = turn * ConstVector3(x + 4) + ConstVector3(delta + 3);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  RowMajor<7, 6>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond turn = ConstRotation(y) * ConstRotation(x).conjugate();
  Eigen::Map<Eigen::Vector3d>{y_minus_x} = AxisAngleOf(turn);
  Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} = ConstVector3(y + 4) - turn * ConstVector3(x + 4);
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  RowMajor<6, 7>(jacobian).setIdentity();
  return true;
}

template <int kRows>
bool ReprojectionCost<kRows>::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const Eigen::Matrix3d rotation = ConstRotation(blocks[0]).toRotationMatrix();
  const Eigen::Vector3d in_camera = rotation * ConstVector3(blocks[1]) + ConstVector3(blocks[0] + 4);
  Eigen::Matrix<double, kRows, 1> error;
  Eigen::Matrix<double, kRows, 3> by_point;
  if (!Predict<kRows>(*measurement_, in_camera, error, by_point)) {
    error.setConstant(kFarOff);
    by_point.setZero();
  }
  Eigen::Map<Eigen::Matrix<double, kRows, 1>> result(residuals);
  result = error;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Matrix<double, kRows, 6> by_motion;
    by_motion << -by_point * Hat(in_camera), by_point;
    SetByPose<kRows>(by_motion, jacobians[0]);
  }
  if (jacobians[1] != nullptr) RowMajor<kRows, 3>{jacobians[1]} = by_point * rotation;
  return true;
}

template class ReprojectionCost<2>;
template class ReprojectionCost<3>;

bool InertialCost::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const Body first(blocks[0], link_->camera_from_body, link_->body);
  const Body second(blocks[3], link_->second_camera_from_body, link_->second_body);
  const InertialErrors errors(*link_, first, second, blocks);
  const Eigen::Matrix<double, 9, 9>& root = link_->root_information;
  Eigen::Map<Eigen::Matrix<double, 9, 1>> result(residuals);
  result = root * errors.errors;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr)
    SetByPose<9>(root * (errors.by_first_turn * first.turn_by_pose + errors.by_first_position * first.position_by_pose),
                 jacobians[0]);
  if (jacobians[1] != nullptr) RowMajor<9, 3>{jacobians[1]} = root * errors.by_velocity;
  if (jacobians[2] != nullptr) RowMajor<9, 6>{jacobians[2]} = root * errors.by_bias;
  if (jacobians[3] != nullptr)
    SetByPose<9>(
        root * (errors.by_second_turn * second.turn_by_pose - errors.by_first_position * second.position_by_pose),
        jacobians[3]);
  if (jacobians[4] != nullptr) RowMajor<9, 3>{jacobians[4]} = root.middleCols<3>(3) * errors.first_from_world;
  return true;
}

bool BiasWalkCost::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const auto& root = link_->walk_root_information;
  using Bias = Eigen::Map<const Eigen::Matrix<double, 6, 1>>;
  Eigen::Map<Eigen::Matrix<double, 6, 1>> result(residuals);
  result = root.cwiseProduct(Bias(blocks[1]) - Bias(blocks[0]));
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) RowMajor<6, 6>{jacobians[0]} = Eigen::Matrix<double, 6, 6>((-root).asDiagonal());
  if (jacobians[1] != nullptr) RowMajor<6, 6>{jacobians[1]} = Eigen::Matrix<double, 6, 6>(root.asDiagonal());
  return true;
}

}  // namespace slamdb::detail
