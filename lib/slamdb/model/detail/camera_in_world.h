// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/rigid.h"

namespace slamdb::detail {

// A pose as tables and trajectories have it: a unit quaternion, and 0 instead of -0, which inverting makes of 0.
inline Rigid3f Tidied(Rigid3f pose) {
  pose.rotation.normalize();
  pose.rotation.coeffs().array() += 0.0F;
  pose.translation.array() += 0.0F;
  return pose;
}

// Where the camera is.
inline Rigid3f CameraInWorld(const Rigid3f& camera_from_world) {
  return Tidied(camera_from_world.Normalized().Inverse());
}

// Where it is in double: of what is far from the origin, floats of the world know less than the pose does.
Eigen::Vector3d ExactCenter(const Rigid3f& camera_from_world);

// The pose of a camera at a place. Rotation and translation say together where that is, so the latter is computed with
// the former as it is rounded.
Rigid3f CameraFromWorld(const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& center);

}  // namespace slamdb::detail
