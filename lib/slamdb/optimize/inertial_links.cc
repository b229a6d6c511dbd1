// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/inertial_links.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <optional>

#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

bool IsUsable(const KeyFrame& keyframe) {
  return IsPosed(keyframe) && keyframe.imu_calibration.is_set && keyframe.velocity.allFinite() &&
         keyframe.imu_bias.gyroscope.allFinite() && keyframe.imu_bias.accelerometer.allFinite() &&
         IsPose(keyframe.imu_calibration.camera_from_body);
}

bool IsMeasured(const ImuPreintegration& imu) {
  return imu.duration > 0 && std::isfinite(imu.duration) && imu.rotation.allFinite() && imu.velocity.allFinite() &&
         imu.position.allFinite() && imu.rotation_by_gyro.allFinite() && imu.velocity_by_gyro.allFinite() &&
         imu.velocity_by_acc.allFinite() && imu.position_by_gyro.allFinite() && imu.position_by_acc.allFinite() &&
         imu.bias.gyroscope.allFinite() && imu.bias.accelerometer.allFinite() && imu.covariance.allFinite() &&
         std::abs(imu.rotation.determinant() - 1) < 0.1F;
}

// The matrix that makes errors of that covariance white; nullopt where it is no covariance.
std::optional<Eigen::Matrix<double, 9, 9>> RootInformation(const Matrix15f& recorded) {
  const Eigen::Matrix<double, 9, 9> covariance = recorded.topLeftCorner<9, 9>().cast<double>();
  const Eigen::LLT<Eigen::Matrix<double, 9, 9>> root(0.5 * (covariance + covariance.transpose()));
  if (root.info() != Eigen::Success) return std::nullopt;
  Eigen::Matrix<double, 9, 9> whitening = root.matrixL().solve(Eigen::Matrix<double, 9, 9>::Identity());
  if (!whitening.allFinite()) return std::nullopt;
  return whitening;
}

void SetMounts(const KeyFrame& first, const KeyFrame& second, InertialLink& link) {
  const auto rotation = [](const KeyFrame& keyframe) {
    return keyframe.imu_calibration.camera_from_body.rotation.cast<double>().normalized().toRotationMatrix();
  };
  link.camera_from_body = rotation(first);
  link.second_camera_from_body = rotation(second);
  link.body = first.imu_calibration.camera_from_body.translation.cast<double>();
  link.second_body = second.imu_calibration.camera_from_body.translation.cast<double>();
}

std::optional<InertialLink> LinkOf(const KeyFrame& first, const KeyFrame& second) {
  const ImuPreintegration& imu = second.preintegration;
  if (!IsUsable(first) || !IsUsable(second) || !IsMeasured(imu)) return std::nullopt;
  const auto root = RootInformation(imu.covariance);
  const Eigen::Matrix<double, 6, 1> walk = imu.covariance.diagonal().tail<6>().cast<double>();
  if (!root || !(walk.minCoeff() > 0)) return std::nullopt;
  InertialLink link{};
  link.duration = static_cast<double>(imu.duration);
  link.rotation = Eigen::Quaterniond(imu.rotation.cast<double>()).normalized().toRotationMatrix();
  link.velocity = imu.velocity.cast<double>();
  link.position = imu.position.cast<double>();
  link.bias << imu.bias.gyroscope.cast<double>(), imu.bias.accelerometer.cast<double>();
  link.rotation_by_gyro = imu.rotation_by_gyro.cast<double>();
  link.velocity_by_bias << imu.velocity_by_gyro.cast<double>(), imu.velocity_by_acc.cast<double>();
  link.position_by_bias << imu.position_by_gyro.cast<double>(), imu.position_by_acc.cast<double>();
  link.root_information = *root;
  link.walk_root_information = walk.cwiseSqrt().cwiseInverse();
  SetMounts(first, second, link);
  return link;
}

}  // namespace

bool KnowsGravity(const Map& map) {
  if (!map.imu_initialized) return false;
  const auto gravity = GravityByInertia(map);
  if (!gravity || !gravity->allFinite() || gravity->isZero()) return true;
  return -gravity->normalized().z() > std::cos(kLargestTilt * std::numbers::pi / 180);
}

std::vector<InertialLink> FindInertialLinks(const Map& map, std::uint64_t& unusable) {
  std::vector<InertialLink> links;
  if (!KnowsGravity(map)) return links;
  const IdTable rows = KeyFrameTable(map);
  for (std::uint32_t second = 0; second < map.keyframes.size(); ++second) {
    const std::uint32_t first = rows.Find(map.keyframes[second].previous.value());
    if (first == kNoRow || first == second || map.keyframes[second].bad) continue;
    auto link = LinkOf(map.keyframes[first], map.keyframes[second]);
    unusable += link ? 0 : 1;
    if (!link) continue;
    link->first = first;
    link->second = second;
    links.push_back(*link);
  }
  return links;
}

}  // namespace slamdb::detail
