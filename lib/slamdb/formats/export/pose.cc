// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/pose.h"

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/camera_in_world.h"

namespace slamdb::detail {

Rigid3f PoseInWorld(const KeyFrame& keyframe, PoseFrame frame) {
  return frame == PoseFrame::kBody ? Tidied(WorldFromBody(keyframe)) : CameraInWorld(keyframe.camera_from_world);
}

}  // namespace slamdb::detail
