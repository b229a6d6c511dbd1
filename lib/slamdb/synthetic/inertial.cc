// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/inertial.h"

namespace slamdb::synthetic {
namespace {

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix96d = Eigen::Matrix<double, 9, 6>;

constexpr int kMeasurements = 50;  // between keyframes: 200 Hz
constexpr double kStep = kKeyframeInterval / kMeasurements;
constexpr double kGravity = 9.81;
// Of a good MEMS unit, per square root of Hz and as ORB-SLAM3's own settings of the EuRoC data set.
constexpr double kGyroNoise = 1.7e-4, kAccNoise = 2e-3, kGyroWalk = 1.9393e-5, kAccWalk = 3e-3;

Vector6f Variances(double gyro, double acc, double rate) {
  Vector6f variances;
  const auto g = static_cast<float>(gyro * gyro * rate), a = static_cast<float>(acc * acc * rate);
  variances << g, g, g, a, a, a;
  return variances;
}

// Discrete variances: a density squared times the rate, and a walk squared over it.
Vector6f Noise() { return Variances(kGyroNoise, kAccNoise, 1 / kStep); }
Vector6f WalkNoise() { return Variances(kGyroWalk, kAccWalk, kStep); }

Pose WorldFromBody(const Rig& rig, const Room& room, double seconds) {
  return room.WorldFromCamera(seconds) * rig.camera_from_body;
}

// The slope of the path over one measurement, so that sums of accelerations give differences of velocities exactly.
Eigen::Vector3d Velocity(const Rig& rig, const Room& room, double seconds) {
  const Eigen::Vector3d ahead = WorldFromBody(rig, room, seconds + kStep / 2).translation;
  const Eigen::Vector3d behind = WorldFromBody(rig, room, seconds - kStep / 2).translation;
  return (ahead - behind) / kStep;
}

// Right Jacobian of the rotation group.
Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& axis_angle) {
  const double angle = Norm(axis_angle);
  const Eigen::Matrix3d hat = Hat(axis_angle);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() - hat * 0.5;
  return Eigen::Matrix3d::Identity() - hat * ((1 - Cosine(angle)) / (angle * angle)) +
         Product(hat, hat) * ((angle - Sine(angle)) / (angle * angle * angle));
}

// Forster et al. (TRO 2017), equations 35 to 38 and 63, and the bias Jacobians of their appendix.
class Integration {
 public:
  void Add(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& angular_velocity) {
    const double dt = kStep;
    const Eigen::Matrix3d turn = Rotation(angular_velocity * dt), turn_back = turn.transpose();
    const Eigen::Matrix3d jacobian = RightJacobian(angular_velocity * dt) * dt;
    const Eigen::Matrix3d lever = Product(rotation, Hat(acceleration));
    Propagate(turn_back, jacobian, lever);
    const Eigen::Vector3d push = Product(rotation, acceleration);
    const Eigen::Matrix3d lever_by_gyro = Product(lever, rotation_by_gyro);
    position += velocity * dt + push * (0.5 * dt * dt);
    velocity += push * dt;
    position_by_acc += velocity_by_acc * dt - rotation * (0.5 * dt * dt);
    position_by_gyro += velocity_by_gyro * dt - lever_by_gyro * (0.5 * dt * dt);
    velocity_by_acc -= rotation * dt;
    velocity_by_gyro -= lever_by_gyro * dt;
    rotation_by_gyro = Product(turn_back, rotation_by_gyro) - jacobian;
    rotation = Product(rotation, turn);
    mean_acceleration += push / kMeasurements;
    mean_angular_velocity += angular_velocity / kMeasurements;
  }

  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_by_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero(), velocity_by_acc = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero(), position_by_acc = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_acceleration = Eigen::Vector3d::Zero(), mean_angular_velocity = Eigen::Vector3d::Zero();
  Matrix9d covariance = Matrix9d::Zero();  // rotation, velocity, position

 private:
  void Propagate(const Eigen::Matrix3d& turn_back, const Eigen::Matrix3d& jacobian, const Eigen::Matrix3d& lever) {
    const double dt = kStep;
    Matrix9d a = Matrix9d::Identity();
    a.block<3, 3>(0, 0) = turn_back;
    a.block<3, 3>(3, 0) = lever * -dt;
    a.block<3, 3>(6, 0) = lever * (-0.5 * dt * dt);
    a.block<3, 3>(6, 3) = Eigen::Matrix3d::Identity() * dt;
    Matrix96d b = Matrix96d::Zero();
    b.block<3, 3>(0, 0) = jacobian;
    b.block<3, 3>(3, 3) = rotation * dt;
    b.block<3, 3>(6, 3) = rotation * (0.5 * dt * dt);
    const Vector6f noise = Noise();
    Matrix96d weighted = b;
    for (int column = 0; column < 6; ++column) weighted.col(column) *= noise[column];
    const Matrix9d a_transposed = a.transpose();
    const Eigen::Matrix<double, 6, 9> b_transposed = b.transpose();
    covariance = Product(Product(a, covariance), a_transposed) + Product(weighted, b_transposed);
  }
};

void Record(const Integration& motion, ImuPreintegration& record) {
  record.duration = static_cast<float>(kKeyframeInterval);
  record.covariance.block<9, 9>(0, 0) = motion.covariance.cast<float>();
  for (int i = 0; i < 6; ++i) record.covariance(9 + i, 9 + i) = WalkNoise()[i] * kMeasurements;
  record.rotation = motion.rotation.cast<float>();
  record.velocity = motion.velocity.cast<float>();
  record.position = motion.position.cast<float>();
  record.rotation_by_gyro = motion.rotation_by_gyro.cast<float>();
  record.velocity_by_gyro = motion.velocity_by_gyro.cast<float>();
  record.velocity_by_acc = motion.velocity_by_acc.cast<float>();
  record.position_by_gyro = motion.position_by_gyro.cast<float>();
  record.position_by_acc = motion.position_by_acc.cast<float>();
  record.mean_acceleration = motion.mean_acceleration.cast<float>();
  record.mean_angular_velocity = motion.mean_angular_velocity.cast<float>();
}

void Preintegrate(ImuPreintegration& record, const Rig& rig, const Room& room, double begin, const ImuBias& bias) {
  Integration motion;
  record.noise = Noise();
  record.walk_noise = WalkNoise();
  record.measurements.reserve(kMeasurements);
  Pose pose = WorldFromBody(rig, room, begin);
  Eigen::Vector3d velocity = Velocity(rig, room, begin);
  for (int i = 1; i <= kMeasurements; ++i) {
    const double time = begin + i * kStep;
    const Pose next_pose = WorldFromBody(rig, room, time);
    const Eigen::Vector3d next_velocity = Velocity(rig, room, time);
    const Eigen::Matrix3d body_from_world = pose.rotation.transpose();
    const Eigen::Vector3d push = (next_velocity - velocity) / kStep + Eigen::Vector3d(0, 0, kGravity);
    const Eigen::Vector3d acceleration = Product(body_from_world, push);
    const Eigen::Vector3d turn = AxisAngle(Product(body_from_world, next_pose.rotation)) / kStep;
    motion.Add(acceleration, turn);
    record.measurements.push_back({acceleration.cast<float>() + bias.accelerometer, turn.cast<float>() + bias.gyroscope,
                                   static_cast<float>(kStep)});
    pose = next_pose;
    velocity = next_velocity;
  }
  Record(motion, record);
}

}  // namespace

void AddInertial(KeyFrame& keyframe, const Rig& rig, const Room& room, double seconds, const ImuBias& bias,
                 bool is_first) {
  keyframe.imu_bias = bias;
  keyframe.preintegration.bias = bias;
  keyframe.preintegration.updated_bias = bias;
  if (!is_first) Preintegrate(keyframe.preintegration, rig, room, seconds - kKeyframeInterval, bias);
  keyframe.imu_calibration = {rig.camera_from_body.Recorded(), rig.camera_from_body.Inverse().Recorded(), Noise(),
                              WalkNoise(), true};
  keyframe.imu_initialized = true;
  keyframe.velocity = Velocity(rig, room, seconds).cast<float>();
  keyframe.body_position = WorldFromBody(rig, room, seconds).translation.cast<float>();
  keyframe.has_velocity = true;
}

}  // namespace slamdb::synthetic
