// SPDX-License-Identifier: BSD-3-Clause
//
// Apart from what they are called by: GCC 12 at -O3 takes a float that is made of a double, and made one again in the
// same function, for that double, and who compares both sees no rounding.
#include "slamdb/model/detail/camera_in_world.h"

namespace slamdb::detail {

Eigen::Vector3d ExactCenter(const Rigid3f& camera_from_world) {
  return -(camera_from_world.rotation.cast<double>().normalized().conjugate() *
           camera_from_world.translation.cast<double>());
}

Rigid3f CameraFromWorld(const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& center) {
  const Quaternionf rotation(world_from_camera.conjugate().normalized().cast<float>());
  return {rotation, (-(rotation.cast<double>().normalized() * center)).cast<float>()};
}

}  // namespace slamdb::detail
