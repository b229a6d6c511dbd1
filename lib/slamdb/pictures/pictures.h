// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/pictures/camera_settings.h"

// Pictures and their ORB features. OpenCV works on the pictures; where slamdb was built without it, everything here
// throws Error (kUnsupported), which names the packages that are missing.
namespace slamdb {

// A gray picture: row after row, a byte a pixel.
struct GrayPicture {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

// Reads a PNG, JPEG, PGM or PPM picture, told by its content. Colours become gray, 16 bits a channel 8; what EXIF says
// of its orientation is left alone, as ORB-SLAM3's examples do.
//
// Throws Error as WholeFile does, kDamaged when it is no picture, and kOutOfResources when it has more than 2^26
// pixels.
[[nodiscard]] SLAMDB_EXPORT GrayPicture ReadPicture(const Source& source);

// The ORB features of a picture, spread over it as ORB-SLAM3 spreads them:
//   a pyramid, each level with a share of the features
//   FAST corners in cells of 35 pixels, with the lower threshold where the higher one finds none
//   a quadtree, of each of whose leaves the strongest corner is kept
//   orientation by the intensity centroid; rotated BRIEF of the blurred level
// `features`: how many, about; a few more may be found.
// A picture of another size than that of the settings' files is refused.
//
// Throws Error (kNotPossible) for a size that differs.
// Cost: about linear in the pixels. Thread-safe. Deterministic.
// After Rublee et al., ICCV 2011, and ORB-SLAM (Mur-Artal et al., TRO 2015).
[[nodiscard]] SLAMDB_EXPORT PictureFeatures ExtractFeatures(const GrayPicture& picture, const CameraSettings& settings,
                                                            std::int32_t features);

}  // namespace slamdb
