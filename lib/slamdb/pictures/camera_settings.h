// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/camera.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/picture_features.h"

namespace slamdb {

// How a camera takes pictures, and how features are found in them.
struct CameraSettings {
  Camera camera;                                 // of pictures of `width` x `height`
  std::vector<double> distortion;                // k1 k2 p1 p2 [k3] of a pinhole (Brown); empty: none
  std::int32_t width = 0, height = 0;            // of the pictures that features are found in, pixels; 0: of any size
  std::int32_t file_width = 0, file_height = 0;  // of picture files, which are scaled to the above; 0: the same

  // ORBextractor.*
  std::int32_t features = 0;  // 0: not said
  float scale_factor = 1.2F;
  std::int32_t levels = 8;
  std::int32_t initial_threshold = 20, least_threshold = 7;  // of FAST, gray levels
};

// Reads the settings file of ORB-SLAM3 (Camera.type, Camera1.*) or of ORB-SLAM2 (Camera.fx, ...): of YAML the lines
// `name: number` or `name: "text"`; others are passed over. Of a pair of cameras the first.
//
// Throws Error as WholeFile does, and kDamaged, with the line, when a number is missing or not one, a focal length or a
// size not positive, or the model of the camera unknown.
[[nodiscard]] SLAMDB_EXPORT CameraSettings ReadCameraSettings(const Source& source);

// The distortion that a keyframe of a pinhole records, k1 k2 p1 p2 [k3] without zeros at its end, where it is floats;
// empty: none, or not finite.
[[nodiscard]] SLAMDB_EXPORT std::vector<double> DistortionOf(const KeyFrame& keyframe);

// Where a pixel would be, had the lens no distortion: found by iterating Brown's model, as cv::undistortPoints does.
// Without distortion, or for Kannala-Brandt, the pixel itself.
[[nodiscard]] SLAMDB_EXPORT Eigen::Vector2d Undistorted(const CameraSettings& settings, const Eigen::Vector2d& pixel);

// Where the corners of a picture would be, as ORB-SLAM3 records it: pixels without their fractions. It looks at no
// other places of the sides. Without a grid.
[[nodiscard]] SLAMDB_EXPORT ImageBounds UndistortedBounds(const CameraSettings& settings, std::int32_t width,
                                                          std::int32_t height);

// The camera of the first keyframe of an atlas whose pictures were of that size, as far as its recorded bounds tell.
// nullopt when there is none.
[[nodiscard]] SLAMDB_EXPORT std::optional<CameraSettings> SettingsOfMap(const Atlas& atlas, std::int32_t width,
                                                                        std::int32_t height);

// The features of a picture as they would be found with other settings: those that `found` with, whose lens had no
// distortion, differ from them in the camera and its distortion alone. nullopt: they differ in more.
[[nodiscard]] SLAMDB_EXPORT std::optional<PictureFeatures> WithCamera(const PictureFeatures& features,
                                                                      const CameraSettings& found,
                                                                      const CameraSettings& other);

}  // namespace slamdb
