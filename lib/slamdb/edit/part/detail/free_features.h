// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Drops the features that see no map point: keypoints, descriptors, their entries in grids and feature vectors; the
// rows of those that stay close up, and slots, stereo matches and observations name the new rows. Bags of words stay as
// they are, so that place recognition finds the same keyframes. Keypoints of the right image of a rectified pair, which
// ORB-SLAM3 does not use, go too. Keyframes that see no point at all, or whose columns disagree, stay as they are.
// Tracking and relocalisation only use features with points; mapping triangulates new ones from the others. Linear; in
// place; on `threads` threads (0: every core). Returns the number of features dropped.
std::uint64_t DropFreeFeatures(Atlas& atlas, int threads = 0);

// Bytes of a keyframe's features in a binary .osa file, for knowing beforehand what DropFreeFeatures leaves.
struct FeatureSizes {
  std::uint64_t all = 0;      // of all rows
  std::uint64_t of_view = 0;  // of the rows that see one point, at most
  std::uint64_t unused = 0;   // of what goes whole
};
// Zeros where it leaves everything.
FeatureSizes SizesOf(const Features& features);

}  // namespace slamdb::detail
