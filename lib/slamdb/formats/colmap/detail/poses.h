// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "slamdb/formats/colmap/detail/model.h"
#include "slamdb/formats/import/detail/possible.h"

namespace slamdb::colmap {

// Of the length that it is recorded with.
inline Eigen::Quaterniond RotationOf(const Pose& pose) {
  return Eigen::Quaterniond(pose.wxyz[0], pose.wxyz[1], pose.wxyz[2], pose.wxyz[3]);
}
inline Eigen::Vector3d TranslationOf(const Pose& pose) {
  return Eigen::Map<const Eigen::Vector3d>(pose.translation.data());
}
inline Pose PoseOf(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  return {{rotation.w(), rotation.x(), rotation.y(), rotation.z()},
          {translation.x(), translation.y(), translation.z()}};
}

inline Rigid3f RigidOf(const Pose& pose) { return detail::PoseOf(RotationOf(pose), TranslationOf(pose)); }

// As the end of an error; empty: they are numbers of one.
inline std::string WhyNoPose(const Pose& pose) { return detail::WhyNoPose(RotationOf(pose), TranslationOf(pose)); }
inline std::string WhyNoPosition(const Point& point) {
  return detail::WhyNoPosition(Eigen::Map<const Eigen::Vector3d>(point.position.data()));
}

inline Pose Inverse(const Pose& pose) {
  const Eigen::Quaterniond rotation = RotationOf(pose).conjugate();
  return PoseOf(rotation, -(rotation.normalized() * TranslationOf(pose)));
}
inline Pose Compose(const Pose& a_from_b, const Pose& b_from_c) {
  const Eigen::Quaterniond turn = RotationOf(a_from_b).normalized();
  return PoseOf(turn * RotationOf(b_from_c), turn * TranslationOf(b_from_c) + TranslationOf(a_from_b));
}

}  // namespace slamdb::colmap
