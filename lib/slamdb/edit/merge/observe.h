// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// A point, and the keypoint of a keyframe that it is.
struct SeenPoint {
  MapPointId point;
  KeyFrameId keyframe;
  std::uint32_t keypoint = 0;  // row; of a fisheye pair those of the right picture stand behind those of the left
};

// Records that keyframes see points, on both sides, in the given order.
// Passed over are points, keyframes and keypoints that are not there, keypoints that are a point already, and points
// that the keyframe sees already.
// Counts, descriptors and viewing directions of the points follow, and the covisibility of all keyframes that see them.
// Returns how many observations were added.
//
// Throws nothing but std::bad_alloc.
// Cost: linear, in place.
SLAMDB_EXPORT std::uint64_t AddObservations(Map& map, std::span<const SeenPoint> seen);

}  // namespace slamdb
