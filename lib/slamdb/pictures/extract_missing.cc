// SPDX-License-Identifier: BSD-3-Clause
// In place of extract.cc where OpenCV's modules for pictures are not there.
#include "slamdb/base/error.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb {
namespace {

[[noreturn]] void RefuseAll() {
  throw Error(ErrorKind::kNotPossible,
              "slamdb was built without pictures: install libopencv-features2d-dev and libopencv-imgcodecs-dev, and "
              "build it again");
}

}  // namespace

GrayPicture ReadPicture(const Source&) { RefuseAll(); }

PictureFeatures ExtractFeatures(const GrayPicture&, const CameraSettings&, std::int32_t) { RefuseAll(); }

}  // namespace slamdb
