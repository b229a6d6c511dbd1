// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/camera.h"
#include "slamdb/model/keyframe.h"

// What a keyframe was seen through, as numbers that can be compared between programs.
namespace slamdb::detail {

// What a keyframe says of distortion: k1 k2 p1 p2 [k3], without zeros at the end. Empty: none. nullopt: what it says is
// not of floats, or not finite.
SLAMDB_EXPORT std::optional<std::vector<double>> RecordedDistortion(const KeyFrame& keyframe);
// The same; none where that cannot be told.
SLAMDB_EXPORT std::vector<double> DistortionCoefficients(const KeyFrame& keyframe);

// fx fy cx cy, then the distortion: of a fisheye lens the camera's, else the keyframe's. Empty when the focal length is
// not known. `camera`: the keyframe's, or null.
SLAMDB_EXPORT std::vector<double> LensNumbers(const KeyFrame& keyframe, const Camera* camera);

// But for rounding: to a thousandth of a pixel or so in an image of usual size. Missing numbers are zeros.
SLAMDB_EXPORT bool AreLensesAlike(const std::vector<double>& one, const std::vector<double>& other);

// `458.654 457.296 367.215 248.375 -0.283408`
SLAMDB_EXPORT std::string LensText(const std::vector<double>& lens);

}  // namespace slamdb::detail
