// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/upward.h"

namespace slamdb::detail {

Eigen::Vector3f UpwardAxis(const Map& map) {
  constexpr double kClear = 0.5;  // of the mean of unit vectors, along one axis
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t cameras = 0;
  for (const KeyFrame& keyframe : map.keyframes) {
    const Quaternionf rotation = keyframe.camera_from_world.rotation.normalized();
    if (keyframe.bad || !rotation.coeffs().allFinite()) continue;
    sum -= (rotation.conjugate() * Eigen::Vector3f::UnitY()).cast<double>();
    ++cameras;
  }
  Eigen::Index axis = 0;
  if (cameras > 0 && sum.cwiseAbs().maxCoeff(&axis) >= kClear * static_cast<double>(cameras))
    return static_cast<float>(sum[axis] < 0 ? -1 : 1) * Eigen::Vector3f::Unit(axis);
  return map.imu_initialized ? Eigen::Vector3f(0, 0, 1) : Eigen::Vector3f(0, -1, 0);
}

Quaternionf TurnOf(const Eigen::Vector3f& axis, const Eigen::Vector3f& onto) {
  if (axis == -onto) return {0, 1, 0, 0};
  return Quaternionf(Eigen::Quaternionf::FromTwoVectors(axis, onto));
}

}  // namespace slamdb::detail
