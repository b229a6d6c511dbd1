// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/model/atlas.h"

// Members of keyframes that ORB-SLAM3 writes without ever having set them where they do not apply. It does not read
// them back either, but they make files differ from run to run, and text archives of `nan` unreadable to its loader.
// Pure functions, thread-safe.
namespace slamdb::detail {

// The merge scale of a keyframe that took part in no merge; one that is a scale, 0.001 to 1000, counts as set.
bool HasWildMergeScale(const KeyFrame& keyframe);
// The preintegration, but for its biases, and the body position in a map without IMU. 0 and identity are not wild.
bool HasWildPreintegration(const Map& map, const KeyFrame& keyframe);
bool HasWildBodyPosition(const Map& map, const KeyFrame& keyframe);
// The noise of a calibration that is not set.
bool HasWildNoise(const KeyFrame& keyframe);

// How many members of each kind were reset.
struct UninitialisedCounts {
  std::size_t merge_scales = 0, preintegrations = 0, body_positions = 0, noises = 0;
  std::size_t Total() const { return merge_scales + preintegrations + body_positions + noises; }
};

// Sets what is wild to 0, and the rotation of a preintegration to identity. Doing it again changes nothing.
UninitialisedCounts ResetUninitialised(Map& map);

}  // namespace slamdb::detail
