// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/keyframe.h"
#include "slamdb/pictures/camera_settings.h"

namespace slamdb::detail {

// What a keyframe records of its camera: its id, focal lengths and principal point, distortion, and where pictures of
// that size end, without a grid.
void RecordCamera(const CameraSettings& settings, KeyFrame& keyframe);

// What it records of the right camera of a pair.
void RecordPair(CameraId right, const Rigid3f& left_from_right, KeyFrame& keyframe);

// Keypoints where a pinhole without distortion would see them; else as they are.
Column<Keypoint> WithoutDistortion(const CameraSettings& settings, Column<Keypoint> keypoints);

}  // namespace slamdb::detail
