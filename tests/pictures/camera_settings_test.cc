// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/camera_settings.h"

#include <gmock/gmock.h>

#include "slamdb/synthetic/synthesize.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CameraSettings Read(const std::string& text) {
  const TemporaryFolder folder;
  return ReadCameraSettings(folder.Make("camera.yaml", "%YAML:1.0\n" + text));
}

TEST(CameraSettings, OfOrbSlam3) {
  const CameraSettings settings = Read(
      "Camera.type: \"PinHole\"\nCamera1.fx: 458.5 # pixels\nCamera1.fy: 457.25\nCamera1.cx: 367\nCamera1.cy: 248\n"
      "Camera1.k1: -0.28\nCamera1.k2: 0.07\nCamera1.p1: 0.0002\nCamera1.p2: 0.0\nCamera.width: 752\nCamera.height: "
      "480\n"
      "Camera.newWidth: 376\nCamera.newHeight: 240\nORBextractor.nFeatures: 1200\nORBextractor.scaleFactor: 1.25\n"
      "ORBextractor.nLevels: 6\nORBextractor.iniThFAST: 18\nORBextractor.minThFAST: 5\n");
  EXPECT_EQ(settings.camera.model, CameraModel::kPinhole);
  EXPECT_THAT(settings.camera.parameters, ElementsAre(229.25F, 228.625F, 183.5F, 124.F));
  EXPECT_THAT(settings.distortion, ElementsAre(-0.28, 0.07, 0.0002));
  EXPECT_EQ(settings.file_width, 752);
  EXPECT_EQ(settings.height, 240);
  EXPECT_EQ(settings.features, 1200);
  EXPECT_EQ(settings.levels, 6);
  EXPECT_EQ(settings.scale_factor, 1.25F);
  EXPECT_EQ(settings.initial_threshold, 18);
  EXPECT_EQ(settings.least_threshold, 5);
}

TEST(CameraSettings, OfOrbSlam2AndFisheye) {
  EXPECT_THAT(Read("Camera.fx: 1\nCamera.fy: 2\nCamera.cx: 3\nCamera.cy: 4\n").camera.parameters,
              ElementsAre(1, 2, 3, 4));
  const CameraSettings fisheye = Read(
      "Camera.type: \"KannalaBrandt8\"\nCamera1.fx: 190\nCamera1.fy: 190\nCamera1.cx: 254\nCamera1.cy: 256\n"
      "Camera1.k1: 0.003\nCamera1.k2: 0.0007\nCamera1.k3: -0.002\nCamera1.k4: 0.0002\n");
  EXPECT_EQ(fisheye.camera.model, CameraModel::kKannalaBrandt8);
  EXPECT_EQ(fisheye.camera.parameters.size(), 8U);
  EXPECT_TRUE(fisheye.distortion.empty());
}

TEST(CameraSettings, OfRectifiedPicturesHaveNoDistortion) {
  EXPECT_TRUE(
      Read("Camera.type: \"Rectified\"\nCamera1.fx: 1\nCamera1.fy: 1\nCamera1.cx: 1\nCamera1.cy: 1\nCamera1.k1: 1\n")
          .distortion.empty());
}

TEST(CameraSettings, AreRefusedWithTheLine) {
  const std::string good = "Camera1.fx: 1\nCamera1.fy: 1\nCamera1.cx: 1\nCamera1.cy: 1\n";
  const auto message = [](const std::string& text) { return MessageOf([&] { (void)Read(text); }); };
  EXPECT_THAT(message("Camera1.fx: 1\n"), HasSubstr("has no `Camera1.fy`"));
  EXPECT_THAT(message("Camera1.fx: wide\n"), HasSubstr("line 2: `Camera1.fx` must be a number"));
  EXPECT_THAT(message("Camera1.fx: nan\n"), HasSubstr("line 2"));
  EXPECT_THAT(message("Camera1.fx: -1\nCamera1.fy: 1\nCamera1.cx: 1\nCamera1.cy: 1\n"), HasSubstr("above 0"));
  EXPECT_THAT(message(good + "Camera.type: \"Omni\"\n"), HasSubstr("line 6: the camera model `Omni`"));
  EXPECT_THAT(message(good + "Camera.width: 1e9\n"), HasSubstr("from 1 to 32768"));
  EXPECT_THAT(message(good + "ORBextractor.nLevels: 99\n"), HasSubstr("from 1 to 32"));
  EXPECT_THAT(message(good + "ORBextractor.scaleFactor: 1\n"), HasSubstr("above 1"));
}

// Brown's model, the way that the lens goes.
Eigen::Vector2d Distorted(const CameraSettings& settings, const Eigen::Vector2d& pixel) {
  const auto& c = settings.camera.parameters;
  const auto& k = settings.distortion;
  const double x = (pixel.x() - static_cast<double>(c[2])) / static_cast<double>(c[0]);
  const double y = (pixel.y() - static_cast<double>(c[3])) / static_cast<double>(c[1]), r2 = x * x + y * y;
  const double radial = 1 + k[0] * r2 + k[1] * r2 * r2;
  return {
      static_cast<double>(c[0]) * (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)) + static_cast<double>(c[2]),
      static_cast<double>(c[1]) * (y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y) +
          static_cast<double>(c[3])};
}

// As far as five steps go, which is what maps have recorded.
TEST(Undistorted, IsTheWayBack) {
  CameraSettings settings;
  settings.camera.parameters = {458, 457, 367, 248};
  settings.distortion = {-0.28, 0.07, 0.0002, 0.00002};
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(100, 60), Eigen::Vector2d(400, 300), Eigen::Vector2d(650, 430)})
    EXPECT_LT((Undistorted(settings, Distorted(settings, pixel)) - pixel).norm(), 0.05);
}

// Those that ORB-SLAM3 recorded of pictures of EuRoC, made smaller: cut off, not rounded.
TEST(UndistortedBounds, AreThoseThatMapsRecord) {
  CameraSettings settings;
  settings.camera.parameters = {458.654F, 457.296F, 325.2F, 240.4F};
  settings.distortion = {-0.2834081, 0.07395907, 0.00019359, 1.7618711e-05};
  const ImageBounds bounds = UndistortedBounds(settings, 640, 480);
  EXPECT_EQ(bounds.min_x, -108);
  EXPECT_EQ(bounds.min_y, -80);
  EXPECT_EQ(bounds.max_x, 741);
  EXPECT_EQ(bounds.max_y, 559);
}

TEST(SettingsOfMap, AreThoseOfItsPicturesAlone) {
  const Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 4, .points = 100, .threads = 1});
  const ImageBounds& bounds = atlas.maps[0].keyframes[0].bounds;
  const auto settings = SettingsOfMap(atlas, bounds.max_x, bounds.max_y);
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->camera.parameters, atlas.cameras[0].parameters);
  EXPECT_FALSE(SettingsOfMap(atlas, bounds.max_x / 2, bounds.max_y));
  EXPECT_FALSE(SettingsOfMap(Atlas(), 640, 480));
}

}  // namespace
}  // namespace slamdb
