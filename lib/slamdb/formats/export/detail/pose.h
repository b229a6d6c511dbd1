// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/export/options.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::detail {

// world_from_camera or world_from_body of a keyframe as files hold it: a unit quaternion (unless the recorded one is
// zero or not finite) and no negative zeros. A keyframe without IMU calibration has its camera for a body.
Rigid3f PoseInWorld(const KeyFrame& keyframe, PoseFrame frame);

}  // namespace slamdb::detail
