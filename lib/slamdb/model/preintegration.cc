// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/preintegration.h"

#include <algorithm>

#include "slamdb/model/detail/rotations.h"

namespace slamdb {
namespace {

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix96d = Eigen::Matrix<double, 9, 6>;

using detail::Hat;
using detail::kSmallAngle;
using detail::RightJacobian;

Eigen::Matrix3d Rotation(const Eigen::Vector3d& axis_angle) {
  const double angle = axis_angle.norm();
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + Hat(axis_angle);
  return Eigen::AngleAxisd(angle, axis_angle / angle).toRotationMatrix();
}

class Integration {
 public:
  explicit Integration(const Vector6f& noise) : noise_(noise.cast<double>()) {}

  // `acceleration` and `turn_rate` without their biases; `dt` in seconds.
  void Add(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& turn_rate, double dt) {
    const Eigen::Matrix3d turn_back = Rotation(turn_rate * dt).transpose();
    const Eigen::Matrix3d jacobian = RightJacobian(turn_rate * dt) * dt;
    const Eigen::Matrix3d lever = rotation * Hat(acceleration);
    Propagate(turn_back, jacobian, lever, dt);
    const Eigen::Vector3d push = rotation * acceleration;
    const Eigen::Matrix3d lever_by_gyro = lever * rotation_by_gyro;
    mean_acceleration = (mean_acceleration * duration + push * dt) / (duration + dt);
    mean_turn_rate = (mean_turn_rate * duration + turn_rate * dt) / (duration + dt);
    position += velocity * dt + push * (0.5 * dt * dt);
    velocity += push * dt;
    position_by_acc += velocity_by_acc * dt - rotation * (0.5 * dt * dt);
    position_by_gyro += velocity_by_gyro * dt - lever_by_gyro * (0.5 * dt * dt);
    velocity_by_acc -= rotation * dt;
    velocity_by_gyro -= lever_by_gyro * dt;
    rotation_by_gyro = turn_back * rotation_by_gyro - jacobian;
    rotation = rotation * turn_back.transpose();
    duration += dt;
  }

  double duration = 0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_by_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero(), velocity_by_acc = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero(), position_by_acc = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_acceleration = Eigen::Vector3d::Zero(), mean_turn_rate = Eigen::Vector3d::Zero();
  Matrix9d covariance = Matrix9d::Zero();  // rotation, velocity, position

 private:
  void Propagate(const Eigen::Matrix3d& turn_back, const Eigen::Matrix3d& jacobian, const Eigen::Matrix3d& lever,
                 double dt) {
    Matrix9d a = Matrix9d::Identity();
    a.block<3, 3>(0, 0) = turn_back;
    a.block<3, 3>(3, 0) = lever * -dt;
    a.block<3, 3>(6, 0) = lever * (-0.5 * dt * dt);
    a.block<3, 3>(6, 3) = Eigen::Matrix3d::Identity() * dt;
    Matrix96d b = Matrix96d::Zero();
    b.block<3, 3>(0, 0) = jacobian;
    b.block<3, 3>(3, 3) = rotation * dt;
    b.block<3, 3>(6, 3) = rotation * (0.5 * dt * dt);
    covariance = a * covariance * a.transpose() + b * noise_.asDiagonal() * b.transpose();
  }

  const Eigen::Matrix<double, 6, 1> noise_;
};

void Record(const Integration& motion, std::size_t steps, ImuPreintegration& imu) {
  imu.duration = static_cast<float>(motion.duration);
  imu.information.setZero();
  imu.covariance.setZero();
  imu.covariance.block<9, 9>(0, 0) = motion.covariance.cast<float>();
  for (int i = 0; i < 6; ++i) imu.covariance(9 + i, 9 + i) = imu.walk_noise[i] * static_cast<float>(steps);
  imu.rotation = motion.rotation.cast<float>();
  imu.velocity = motion.velocity.cast<float>();
  imu.position = motion.position.cast<float>();
  imu.rotation_by_gyro = motion.rotation_by_gyro.cast<float>();
  imu.velocity_by_gyro = motion.velocity_by_gyro.cast<float>();
  imu.velocity_by_acc = motion.velocity_by_acc.cast<float>();
  imu.position_by_gyro = motion.position_by_gyro.cast<float>();
  imu.position_by_acc = motion.position_by_acc.cast<float>();
  imu.mean_acceleration = motion.mean_acceleration.cast<float>();
  imu.mean_angular_velocity = motion.mean_turn_rate.cast<float>();
}

}  // namespace

void Reintegrate(ImuPreintegration& imu, const ImuBias& bias) {
  Integration motion(imu.noise);
  for (const ImuMeasurement& measurement : imu.measurements) {
    const Eigen::Vector3f acceleration = measurement.acceleration - bias.accelerometer;
    const Eigen::Vector3f turn_rate = measurement.angular_velocity - bias.gyroscope;
    motion.Add(acceleration.cast<double>(), turn_rate.cast<double>(), static_cast<double>(measurement.duration));
  }
  Record(motion, imu.measurements.size(), imu);
  imu.bias = bias;
  imu.updated_bias = bias;
  imu.bias_change.setZero();
}

bool JoinPreintegrations(std::span<const ImuPreintegration* const> earlier, ImuPreintegration& imu) {
  const auto is_empty = [](const ImuPreintegration* part) { return part->measurements.empty(); };
  if (imu.measurements.empty() || std::ranges::any_of(earlier, is_empty)) return false;
  Column<ImuMeasurement> joined;
  for (const ImuPreintegration* part : earlier)
    joined.insert(joined.end(), part->measurements.begin(), part->measurements.end());
  joined.insert(joined.end(), imu.measurements.begin(), imu.measurements.end());
  imu.measurements = std::move(joined);
  Reintegrate(imu, imu.updated_bias);
  return true;
}

}  // namespace slamdb
