// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/pose.h"

#include "slamdb/model/derive.h"

namespace slamdb::detail {

Rigid3f PoseInWorld(const KeyFrame& keyframe, PoseFrame frame) {
  Rigid3f pose =
      frame == PoseFrame::kBody ? WorldFromBody(keyframe) : keyframe.camera_from_world.Normalized().Inverse();
  pose.rotation.normalize();
  // Inverting makes -0 of 0, and adding 0 makes 0 of -0.
  pose.rotation.coeffs().array() += 0.0F;
  pose.translation.array() += 0.0F;
  return pose;
}

}  // namespace slamdb::detail
