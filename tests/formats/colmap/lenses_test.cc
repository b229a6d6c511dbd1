// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/lenses.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slamdb::colmap {
namespace {

Camera Of(std::int32_t model, std::vector<double> parameters) {
  return {.id = 3, .model = model, .width = 640, .height = 480, .parameters = std::move(parameters)};
}

struct Read {
  std::int32_t model;
  std::vector<double> parameters;
  CameraModel expected;
  std::vector<float> ours;
  std::vector<double> distortion;
};

TEST(ColmapLenses, AreReadAsOurs) {
  constexpr CameraModel kOurPinhole = CameraModel::kPinhole, kOurFisheye = CameraModel::kKannalaBrandt8;
  const std::vector<Read> all = {
      {kSimplePinhole, {400, 320, 240}, kOurPinhole, {400, 400, 319.5F, 239.5F}, {}},
      {kPinhole, {400, 401, 320, 240}, kOurPinhole, {400, 401, 319.5F, 239.5F}, {}},
      {kSimpleRadial, {400, 320, 240, 0.25}, kOurPinhole, {400, 400, 319.5F, 239.5F}, {0.25, 0, 0, 0}},
      {kRadial, {400, 320, 240, 0.25, 0.5}, kOurPinhole, {400, 400, 319.5F, 239.5F}, {0.25, 0.5, 0, 0}},
      {kOpencv, {400, 401, 320, 240, 1, 2, 3, 4}, kOurPinhole, {400, 401, 319.5F, 239.5F}, {1, 2, 3, 4}},
      {kFullOpencv, {400, 401, 320, 240, 1, 2, 3, 4, 5, 0, 0, 0}, kOurPinhole, {400, 401, 319.5F, 239.5F}, {1, 2, 3, 4, 5}},
      {kOpencvFisheye, {400, 401, 320, 240, 1, 2, 3, 4}, kOurFisheye, {400, 401, 319.5F, 239.5F, 1, 2, 3, 4}, {}},
      {kSimpleRadialFisheye, {400, 320, 240, 1}, kOurFisheye, {400, 400, 319.5F, 239.5F, 1, 0, 0, 0}, {}},
      {kRadialFisheye, {400, 320, 240, 1, 2}, kOurFisheye, {400, 400, 319.5F, 239.5F, 1, 2, 0, 0}, {}},
      {kSimpleFisheye, {400, 320, 240}, kOurFisheye, {400, 400, 319.5F, 239.5F, 0, 0, 0, 0}, {}},
      {kFisheye, {400, 401, 320, 240}, kOurFisheye, {400, 401, 319.5F, 239.5F, 0, 0, 0, 0}, {}},
  };
  for (const Read& read : all) {
    const Camera camera = Of(read.model, read.parameters);
    EXPECT_EQ(WhyNotRead(camera), nullptr) << read.model;
    EXPECT_FALSE(NeedsUndistorting(camera)) << read.model;
    const CameraSettings settings = SettingsOf(camera, CameraId(2));
    EXPECT_EQ(settings.camera.model, read.expected) << read.model;
    EXPECT_EQ(settings.camera.parameters, read.ours) << read.model;
    EXPECT_EQ(settings.distortion, read.distortion) << read.model;
  }
}

TEST(ColmapLenses, AreWrittenAsTheyAreRead) {
  for (const auto& [model, parameters] :
       {std::pair(std::int32_t{kPinhole}, std::vector<double>{400, 401, 320.5, 240.25}),
        std::pair(std::int32_t{kOpencv}, std::vector<double>{400, 401, 320, 240, 0.5, 0.25, 0.125, 0.5}),
        std::pair(std::int32_t{kFullOpencv}, std::vector<double>{400, 401, 320, 240, 0.5, 0.25, 0.125, 0.5, 0.75, 0, 0, 0}),
        std::pair(std::int32_t{kOpencvFisheye}, std::vector<double>{400, 401, 320, 240, 0.5, 0.25, 0.125, 0.5})}) {
    const Camera camera = Of(model, parameters);
    EXPECT_EQ(CameraOf(SettingsOf(camera, CameraId(2)), 3), camera) << model;
  }
}

// Where (0.6, 0.3, 1) is seen, as each model's formula has it, computed elsewhere.
TEST(ColmapLenses, OfOtherModelsAreUndistorted) {
  struct Case {
    std::int32_t model;
    std::vector<double> rest;
    double u, v;
  };
  const std::vector<Case> cases = {
      {kFov, {0.8}, 0.5768835426623328, 0.2884417713311664},
      {kDivision, {-0.2}, 0.553967929896867, 0.2769839649484335},
      {kEucm, {0.5, 1.2}, 0.5354830324424126, 0.2677415162212063},
      {kFullOpencv, {0.1, 0.01, 0.001, -0.002, 0.003, 0.05, 0.02, 0.01}, 0.6096041594999324, 0.3057020797499662},
      {kThinPrismFisheye, {0.1, 0.01, 0.001, -0.002, 0.003, 0.0004, 0.005, -0.006}, 0.5478682327789625, 0.27166476744486256}};
  for (const Case& lens : cases) {
    std::vector<double> parameters = {400, 410, 320.5, 240.5};
    parameters.insert(parameters.end(), lens.rest.begin(), lens.rest.end());
    const Camera camera = Of(lens.model, parameters);
    ASSERT_TRUE(NeedsUndistorting(camera)) << lens.model;
    const Eigen::Vector2d at = UndistortedBy(camera, {400 * lens.u + 320, 410 * lens.v + 240});
    EXPECT_NEAR(at.x(), 400 * 0.6 + 320, 1e-8) << lens.model;
    EXPECT_NEAR(at.y(), 410 * 0.3 + 240, 1e-8) << lens.model;
    EXPECT_TRUE(UndistortedBy(camera, {1e9, -1e9}).allFinite()) << lens.model;
  }
  const Eigen::Vector2d simple = UndistortedBy(Of(kSimpleDivision, {400, 320.5, 240.5, -0.2}),
                                               {400 * 0.553967929896867 + 320, 400 * 0.2769839649484335 + 240});
  EXPECT_NEAR(simple.x(), 560, 1e-8);
}

TEST(ColmapLenses, TellTheSizeOfImagesByTheirBounds) {
  CameraSettings settings;
  settings.camera.parameters = {458, 457, 367, 248};
  ImageBounds bounds;
  bounds.max_x = 752, bounds.max_y = 480;
  EstimateSize(bounds, settings);
  EXPECT_EQ(settings.width, 752);
  EXPECT_EQ(settings.height, 480);
  settings.distortion = {-0.28, 0.074, 0.0002, 1.8e-05};  // of EuRoC
  bounds = UndistortedBounds(settings, 752, 480);
  EXPECT_GT(bounds.max_x, 760);
  EstimateSize(bounds, settings);
  EXPECT_EQ(settings.width, 752);
  EXPECT_EQ(settings.height, 480);
}

}  // namespace
}  // namespace slamdb::colmap
