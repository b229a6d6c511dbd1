// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/pictures/camera_settings.h"

// Pictures in colour. Where slamdb was built without OpenCV, everything here throws Error (kUnsupported), which names
// the packages that are missing.
namespace slamdb {

// Row after row; red, green and blue of a pixel, a byte each.
struct ColorPicture {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

// Reads a PNG, JPEG, PGM or PPM picture, told by its content; gray becomes three equal colours, 16 bits a channel gray.
//
// Throws Error as ReadPicture does.
[[nodiscard]] SLAMDB_EXPORT ColorPicture ReadColorPicture(const Source& source);

enum class PictureFormat { kPng, kJpeg };

// The bytes of a picture file; JPEG in quality 95, with the colours of every pixel.
//
// Throws Error (kNotPossible) when the library that makes it fails.
[[nodiscard]] SLAMDB_EXPORT std::string EncodePicture(const ColorPicture& picture, PictureFormat format);

// What a pinhole without distortion, of the same focal lengths and centre, would have seen: interpolated linearly, and
// black where the camera saw nothing.
//
// Requires: the camera has the parameters of its model.
// Cost: linear in the pixels. Thread-safe. Deterministic.
[[nodiscard]] SLAMDB_EXPORT ColorPicture Undistorted(const ColorPicture& picture, const CameraSettings& settings);

}  // namespace slamdb
