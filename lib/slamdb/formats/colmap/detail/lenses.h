// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slamdb/formats/colmap/detail/model.h"
#include "slamdb/pictures/camera_settings.h"

// COLMAP's cameras and ours. COLMAP counts pixels from the image's corner, we from the centre of its first pixel: half
// a pixel is added on the way there and taken away on the way back.
namespace slamdb::colmap {

inline constexpr double kHalfPixel = 0.5;

// PINHOLE, OPENCV or FULL_OPENCV, as far as the distortion goes; OPENCV_FISHEYE for Kannala-Brandt.
//
// Requires: the camera has the parameters of its model.
Camera CameraOf(const CameraSettings& settings, std::uint32_t id);

// Where a camera as CameraOf() makes them sees a point in its frame: pixels from the corner of the image. nullopt
// behind it.
std::optional<Eigen::Vector2d> SeenBy(const Camera& camera, const Eigen::Vector3d& x_in_camera);

// As the end of an error; empty: numbers that a camera can have.
//
// Requires: the camera has the parameters of its model.
std::string WhyNoCamera(const Camera& camera);

// Why a camera is not read, or null.
const char* WhyNotRead(const Camera& camera);

// Whether the camera has a model that we have not, so that its keypoints are read as those of a lens without
// distortion.
bool NeedsUndistorting(const Camera& camera);

// What the camera is to us; one whose keypoints need undistorting is a pinhole.
//
// Requires: WhyNotRead() is null.
CameraSettings SettingsOf(const Camera& camera, CameraId id);

// Where a pixel would be in our camera, without distortion; both count from the centre of the first pixel. The pixel
// itself where the model has no answer.
//
// Requires: NeedsUndistorting().
Eigen::Vector2d UndistortedBy(const Camera& camera, const Eigen::Vector2d& pixel);

// The size of the images, which maps do not record, by the bounds of their keypoints.
void EstimateSize(const ImageBounds& bounds, CameraSettings& settings);

}  // namespace slamdb::colmap
