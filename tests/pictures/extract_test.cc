// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "slamdb/model/derive.h"
#include "slamdb/pictures/pictures.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

// Squares of many grays, turned and moved little by little: corners everywhere.
GrayPicture Squares(int width, int height, int shift = 0) {
  GrayPicture picture{.width = width, .height = height, .pixels = {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const unsigned cell = static_cast<unsigned>((x + shift) / 17) * 7919U + static_cast<unsigned>(y / 13) * 104729U;
      picture.pixels.push_back(static_cast<std::uint8_t>((cell * 2654435761U) >> 24));
    }
  return picture;
}

CameraSettings SettingsFor(int width, int height) {
  CameraSettings settings;
  settings.camera.parameters = {400, 400, 320, 240};
  settings.width = settings.file_width = width;
  settings.height = settings.file_height = height;
  return settings;
}

TEST(ExtractFeatures, SpreadsAboutAsManyAsAskedFor) {
  const PictureFeatures features = ExtractFeatures(Squares(640, 480), SettingsFor(640, 480), 800);
  EXPECT_NEAR(static_cast<double>(features.keypoints.size()), 800, 80);
  EXPECT_EQ(features.descriptors.size(), features.keypoints.size());
  std::array<int, 4> quarters{};
  for (const Keypoint& keypoint : features.keypoints) {
    EXPECT_TRUE(keypoint.octave >= 0 && keypoint.octave < 8);
    EXPECT_TRUE(keypoint.angle >= 0 && keypoint.angle < 360.01F);
    EXPECT_FLOAT_EQ(keypoint.size, 31 * features.pyramid.factors[static_cast<std::size_t>(keypoint.octave)]);
    ++quarters[(keypoint.x > 320 ? 1U : 0U) + (keypoint.y > 240 ? 2U : 0U)];
  }
  for (const int quarter : quarters) EXPECT_GT(quarter, 120);
}

TEST(ExtractFeatures, FindsTheSameWhereThePictureMoved) {
  const PictureFeatures here = ExtractFeatures(Squares(640, 480), SettingsFor(640, 480), 1000);
  const PictureFeatures moved = ExtractFeatures(Squares(640, 480, 4), SettingsFor(640, 480), 1000);
  std::size_t again = 0, bottom = 0;
  for (std::size_t i = 0; i < here.keypoints.size(); ++i) {
    if (here.keypoints[i].octave != 0) continue;
    ++bottom;
    for (std::size_t j = 0; j < moved.keypoints.size(); ++j)
      if (moved.keypoints[j].octave == 0 && std::abs(moved.keypoints[j].x + 4 - here.keypoints[i].x) < 0.5F &&
          moved.keypoints[j].y == here.keypoints[i].y &&
          HammingDistance(here.descriptors[i], moved.descriptors[j]) <= 20) {
        ++again;
        break;
      }
  }
  EXPECT_GT(4 * again, 2 * bottom);
}

TEST(ExtractFeatures, OfAPictureWithoutCornersOrTooSmallAreNone) {
  EXPECT_TRUE(ExtractFeatures({640, 480, std::vector<std::uint8_t>(640 * 480, 90)}, SettingsFor(640, 480), 500)
                  .keypoints.empty());
  EXPECT_TRUE(ExtractFeatures(Squares(20, 20), SettingsFor(20, 20), 500).keypoints.empty());
}

TEST(ExtractFeatures, RefusesAPictureOfAnotherSize) {
  EXPECT_THAT(MessageOf([] { (void)ExtractFeatures(Squares(320, 240), SettingsFor(640, 480), 500); }),
              HasSubstr("the picture is 320 x 240, and the camera's are 640 x 480"));
}

}  // namespace
}  // namespace slamdb
