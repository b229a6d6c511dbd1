// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/build/build.h"
#include "slamdb/pictures/camera_settings.h"

namespace slamdb::detail {

// Throws Error (kUsage), with the column and `row`, the keyframe's, when the features of a keyframe do not fit
// together.
void RequireFeatures(const NewKeyFrames& given, std::size_t row);

// Fills what was not given of them, but what follows from points and from the picture's bounds.
void CompleteNewFeatures(const CameraSettings& settings, const NewKeyFrames& given, KeyFrame& keyframe);

}  // namespace slamdb::detail
