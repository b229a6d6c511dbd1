// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace slamdb {

// A quaternion without alignment, so that records stay packed.
// Coefficients as recorded, normalised or not.
using Quaternionf = Eigen::Quaternion<float, Eigen::DontAlign>;

// A rigid transform named `target_from_source`: x_in_target = rotation * x_in_source + translation.
// The rotation is as recorded; Normalized() makes it a unit quaternion.
//
// Units: metres, or the map's unit where a monocular map has no scale.
struct Rigid3f {
  Quaternionf rotation = Quaternionf::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();

  Rigid3f Normalized() const { return {rotation.normalized(), translation}; }
  Rigid3f Inverse() const {  // expects a unit quaternion
    const Quaternionf inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
  // The origin of the target in source coordinates: for camera_from_world the camera's centre in the world.
  Eigen::Vector3f Center() const { return -(rotation.conjugate() * translation); }

  // a_from_c = a_from_b * b_from_c
  friend Rigid3f operator*(const Rigid3f& a_from_b, const Rigid3f& b_from_c) {
    return {a_from_b.rotation * b_from_c.rotation, a_from_b.rotation * b_from_c.translation + a_from_b.translation};
  }
  friend Eigen::Vector3f operator*(const Rigid3f& a_from_b, const Eigen::Vector3f& x_in_b) {
    return a_from_b.rotation * x_in_b + a_from_b.translation;
  }
};

}  // namespace slamdb
