// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"
#include "slamdb/synthetic/detail/rig.h"
#include "slamdb/synthetic/detail/room.h"

namespace slamdb::synthetic {

// Fills the inertial data of the keyframe at `seconds` in the room: calibration, bias, velocity, body position, and,
// unless it is the first, the preintegrated motion since the keyframe kKeyframeInterval before with its measurements
// (Forster et al., TRO 2017): integrating them takes the earlier state to this one.
void AddInertial(KeyFrame& keyframe, const Rig& rig, const Room& room, double seconds, const ImuBias& bias,
                 bool is_first);

}  // namespace slamdb::synthetic
