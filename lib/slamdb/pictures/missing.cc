// SPDX-License-Identifier: BSD-3-Clause
// In place of extract.cc and read_picture.cc where a library that they need is not there.
#include "slamdb/base/error.h"
#include "slamdb/pictures/color_picture.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb {
namespace {

[[noreturn]] void RefuseAll() {
  throw Error(
      ErrorKind::kUnsupported,
      "slamdb was built without pictures: install libopencv-features2d-dev, libopencv-imgproc-dev, libpng-dev and "
      "libturbojpeg0-dev, and build it again");
}

}  // namespace

ColorPicture ReadColorPicture(const Source&) { RefuseAll(); }
std::string EncodePicture(const ColorPicture&, PictureFormat) { RefuseAll(); }
ColorPicture Undistorted(const ColorPicture&, const CameraSettings&) { RefuseAll(); }
GrayPicture ReadPicture(const Source&) { RefuseAll(); }

PictureFeatures ExtractFeatures(const GrayPicture&, const CameraSettings&, std::int32_t) { RefuseAll(); }

}  // namespace slamdb
