// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/formats/stella/detail/stella_map.h"
#include "slamdb/model/features.h"
#include "slamdb/model/keyframe.h"

// Lenses: keypoints as detected and undistorted, in pixels of one focal length. Of an equirectangular camera both are
// the same.
namespace slamdb::stella {

Eigen::Vector2d Distorted(const LensCamera& camera, const Eigen::Vector2d& pixel);
Eigen::Vector2d Undistorted(const LensCamera& camera, const Eigen::Vector2d& pixel);

// The places of keypoints changed, all else kept.
Column<Keypoint> Distorted(const LensCamera& camera, const Column<Keypoint>& keypoints);
Column<Keypoint> Undistorted(const LensCamera& camera, const Column<Keypoint>& keypoints);

// As ORB-SLAM3 makes them of a picture: where a pinhole distorts, the undistorted corners, without their fractions.
ImageBounds BoundsOf(const LensCamera& camera);

// The size of the picture that has these bounds, set in the camera. False: none has exactly, and it is the nearest; of
// bounds that are not set, twice the principal point.
bool SetSize(LensCamera& camera, const ImageBounds& bounds);

}  // namespace slamdb::stella
