// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/stella/detail/stella_map.h"

// Cameras of stella_vslam and of ORB-SLAM3.
namespace slamdb::stella {

// As the end of an error; empty: numbers that a camera can have. Zeros: one that nobody knows.
std::string WhyNoCamera(const LensCamera& lens);

// Perspective: a pinhole. Fisheye: Kannala-Brandt. RadialDivision: a pinhole, as which it sees undistorted keypoints.
// Equirectangular: what it is, its parameters the size of the picture; ORB-SLAM3 has no such camera.
Camera CameraOf(const LensCamera& lens, CameraId id);

// What keyframes have of their camera, of an equirectangular one as a pinhole that fits in the middle: intrinsics,
// distortion, bounds, baselines. `depth_threshold`: in metres; where there is none, 40 baselines, which is the default
// of both programs.
void SetLens(KeyFrame& keyframe, const LensCamera& lens, std::optional<double> depth_threshold);

// The camera that a keyframe was taken with, without its name, its setup and the size of its picture. `camera`: the one
// it refers to, or null.
LensCamera LensOf(const KeyFrame& keyframe, const Camera* camera);

}  // namespace slamdb::stella
