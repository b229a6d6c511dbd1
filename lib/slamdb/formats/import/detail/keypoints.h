// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/features.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::detail {

inline constexpr float kPatch = 31;  // pixels: the diameter of what ORB describes at octave 0

// The same at an octave, in whole pixels. Octaves that the pyramid has not count as 0.
float PatchAt(std::int32_t octave, const ScalePyramid& pyramid);

// A keypoint of which a file knows the place alone.
constexpr Keypoint KeypointAt(float x, float y) {
  return {.angle = 0, .response = 0, .size = kPatch, .x = x, .y = y, .class_id = -1, .octave = 0};
}

// Matches the keypoints of both sides of a fisheye pair that are the same point.
void MatchSides(Features& features);

}  // namespace slamdb::detail
