// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/camera_settings.h"
#include "slamdb/pictures/pictures.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a picture, and as the settings of a camera. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  constexpr std::int32_t kMostSide = 512;  // of pictures whose features are found, so that an input takes no second
  const Bytes bytes = std::as_bytes(std::span(data, size));
  fuzz::MayRefuse([&] {
    const GrayPicture picture = ReadPicture({bytes, "picture"});
    fuzz::Require(
        picture.pixels.size() == static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height),
        "a picture has its pixels");
    if (picture.width > kMostSide || picture.height > kMostSide) return;
    const PictureFeatures features = ExtractFeatures(picture, CameraSettings{}, 200);
    fuzz::Require(features.keypoints.size() == features.descriptors.size(), "each keypoint has a descriptor");
  });
  fuzz::MayRefuse([&] {
    const CameraSettings settings = ReadCameraSettings({bytes, "camera.yaml"});
    (void)UndistortedBounds(settings, 64, 48);
  });
  return 0;
}
