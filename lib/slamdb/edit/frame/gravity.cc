// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/gravity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr int kFewestIntervals = 2;

// How much the viewing direction counts beside the x axis of a camera: it decides only where no camera turns.
constexpr double kViewWeight = 1e-2;

// Of the variances of a path, middle to largest: below it the path is a line.
constexpr double kLineRatio = 1e-4;

bool IsUsable(const KeyFrame& keyframe) {
  return !keyframe.bad && keyframe.camera_from_world.rotation.coeffs().allFinite() &&
         keyframe.camera_from_world.translation.allFinite() && keyframe.camera_from_world.rotation.norm() > 0;
}

// The change of velocity that the accelerometer felt since the keyframe before, by that one's newest bias; body frame.
Eigen::Vector3d FeltChange(const ImuPreintegration& imu, const ImuBias& bias) {
  const Eigen::Vector3f change = imu.velocity + imu.velocity_by_gyro * (bias.gyroscope - imu.bias.gyroscope) +
                                 imu.velocity_by_acc * (bias.accelerometer - imu.bias.accelerometer);
  return change.cast<double>();
}

// Columns: the x, y and z axis of the camera in the world.
Eigen::Matrix3d CameraAxes(const KeyFrame& keyframe) {
  return keyframe.camera_from_world.rotation.cast<double>().normalized().conjugate().toRotationMatrix();
}

Eigen::Vector3d AwayFrom(const Eigen::Vector3d& down, const Eigen::Vector3d& normal) {
  return normal.dot(down) > 0 ? Eigen::Vector3d(-normal) : normal;
}

Eigen::Vector3d SumOfDown(const Map& map) {
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  for (const KeyFrame& keyframe : map.keyframes)
    if (IsUsable(keyframe)) down += CameraAxes(keyframe).col(1);
  return down;
}

Upright UpByCameras(const Map& map) {
  Eigen::Matrix3d level = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const KeyFrame& keyframe : map.keyframes) {
    if (!IsUsable(keyframe)) continue;
    const Eigen::Matrix3d axes = CameraAxes(keyframe);
    level += axes.col(0) * axes.col(0).transpose() + kViewWeight * axes.col(2) * axes.col(2).transpose();
    ++count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(level);
  Upright result{.up = AwayFrom(SumOfDown(map), solver.eigenvectors().col(0)), .method = UpMethod::kCameras};
  double roll = 0;
  for (const KeyFrame& keyframe : map.keyframes)
    if (IsUsable(keyframe))
      roll += std::pow(std::asin(std::clamp(CameraAxes(keyframe).col(0).dot(result.up), -1.0, 1.0)), 2);
  result.spread = std::sqrt(roll / count) * 180 / std::numbers::pi;
  return result;
}

Upright UpByPath(const Map& map) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const KeyFrame& keyframe : map.keyframes)
    if (IsUsable(keyframe)) mean += CameraCenter(keyframe).cast<double>(), ++count;
  mean /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const KeyFrame& keyframe : map.keyframes) {
    if (!IsUsable(keyframe)) continue;
    const Eigen::Vector3d from_mean = CameraCenter(keyframe).cast<double>() - mean;
    covariance += from_mean * from_mean.transpose() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d variances = solver.eigenvalues();  // ascending
  if (!(variances[1] > kLineRatio * variances[2]))
    throw Error(ErrorKind::kNotPossible, "the cameras of " + ToString(map.id) +
                                             " lie on one line, which no plane fits; find up by the cameras instead");
  return {.up = AwayFrom(SumOfDown(map), solver.eigenvectors().col(0)),
          .method = UpMethod::kPath,
          .spread = std::sqrt(std::max(variances[0], 0.0))};
}

}  // namespace

std::string_view NameOf(UpMethod method) {
  switch (method) {
    case UpMethod::kInertia:
      return "inertia";
    case UpMethod::kCameras:
      return "cameras";
    case UpMethod::kPath:
      return "path";
    case UpMethod::kAuto:
      break;
  }
  return "auto";
}

std::optional<Eigen::Vector3d> GravityByInertia(const Map& map) {
  if (!map.imu_initialized) return std::nullopt;
  const IdTable rows = KeyFrameTable(map);
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  double seconds = 0;
  int intervals = 0;
  for (const KeyFrame& keyframe : map.keyframes) {
    const std::uint32_t row = rows.Find(keyframe.previous.value());
    const ImuPreintegration& imu = keyframe.preintegration;
    if (row == kNoRow || !(imu.duration > 0) || !keyframe.imu_calibration.is_set) continue;
    const KeyFrame& previous = map.keyframes[row];
    const Eigen::Quaterniond world_from_body = WorldFromBody(previous).rotation.cast<double>().normalized();
    const Eigen::Vector3d by_gravity =
        (keyframe.velocity - previous.velocity).cast<double>() - world_from_body * FeltChange(imu, previous.imu_bias);
    if (!by_gravity.allFinite() || !std::isfinite(imu.duration)) continue;
    change += by_gravity;
    seconds += imu.duration;
    ++intervals;
  }
  if (intervals < kFewestIntervals || !(change.norm() > 0)) return std::nullopt;
  return change / seconds;
}

std::optional<Eigen::Vector3d> UpByInertia(const Map& map) {
  const std::optional<Eigen::Vector3d> gravity = GravityByInertia(map);
  if (!gravity) return std::nullopt;
  return -gravity->normalized();
}

Upright FindUp(const Map& map, UpMethod method) {
  if (!std::ranges::any_of(map.keyframes, IsUsable))
    throw Error(ErrorKind::kNotPossible, ToString(map.id) + " has no keyframe that could tell which way is up");
  const std::optional<Eigen::Vector3d> gravity =
      method == UpMethod::kAuto || method == UpMethod::kInertia ? GravityByInertia(map) : std::nullopt;
  if (method == UpMethod::kInertia && !gravity)
    throw Error(
        ErrorKind::kNotPossible,
        ToString(map.id) + " has no initialised IMU to tell which way is up; find it by the cameras or by the path");
  Upright result;
  if (gravity)
    result = {.up = -gravity->normalized(), .method = UpMethod::kInertia, .gravity = gravity->norm()};
  else
    result = method == UpMethod::kPath ? UpByPath(map) : UpByCameras(map);
  result.target_from_source = Eigen::Quaterniond::FromTwoVectors(result.up, Eigen::Vector3d::UnitZ());
  return result;
}

}  // namespace slamdb
