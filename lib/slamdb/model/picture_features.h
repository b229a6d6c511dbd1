// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/camera.h"
#include "slamdb/model/features.h"
#include "slamdb/model/keyframe.h"

namespace slamdb {

// What one picture shows and the camera that took it: all that finding its place in a map needs.
//
// Units: pixels of the full-size picture; undistorted for a pinhole, as detected for Kannala-Brandt.
struct PictureFeatures {
  Camera camera;         // its id means nothing
  ImageBounds bounds;    // of the keypoints' picture; its grid means nothing
  ScalePyramid pyramid;  // that the octaves of keypoints are levels of
  Column<Keypoint> keypoints;
  Column<Descriptor> descriptors;  // as many
};

// What a keyframe has recorded of its picture, of the left one of a pair.
// Without keypoints where its camera is missing.
[[nodiscard]] SLAMDB_EXPORT PictureFeatures FeaturesOf(const Atlas& atlas, const KeyFrame& keyframe);

// Those of the left picture of a pair, or of the only one. Refers to the features.
[[nodiscard]] SLAMDB_EXPORT std::span<const Descriptor> LeftDescriptors(const Features& features);

}  // namespace slamdb
