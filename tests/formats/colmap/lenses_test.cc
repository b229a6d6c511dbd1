// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/lenses.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "slamdb/model/derive.h"

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
      {kFullOpencv,
       {400, 401, 320, 240, 1, 2, 3, 4, 5, 0, 0, 0},
       kOurPinhole,
       {400, 401, 319.5F, 239.5F},
       {1, 2, 3, 4, 5}},
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
        std::pair(std::int32_t{kFullOpencv},
                  std::vector<double>{400, 401, 320, 240, 0.5, 0.25, 0.125, 0.5, 0.75, 0, 0, 0}),
        std::pair(std::int32_t{kOpencvFisheye}, std::vector<double>{400, 401, 320, 240, 0.5, 0.25, 0.125, 0.5})}) {
    const Camera camera = Of(model, parameters);
    EXPECT_EQ(CameraOf(SettingsOf(camera, CameraId(2)), 3), camera) << model;
  }
}

// What the documentation of COLMAP calls k1 to k4, p1 and p2.
struct Bend {
  bool fisheye = false;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0;
};
Bend BendOf(const Camera& camera) {
  const std::vector<double>& p = camera.parameters;
  switch (camera.model) {
    case kSimpleRadial:
      return {.k1 = p[3]};
    case kRadial:
      return {.k1 = p[3], .k2 = p[4]};
    case kOpencv:
      return {.k1 = p[4], .k2 = p[5], .p1 = p[6], .p2 = p[7]};
    case kFullOpencv:
      return {.k1 = p[4], .k2 = p[5], .p1 = p[6], .p2 = p[7], .k3 = p[8]};
    case kOpencvFisheye:
      return {.fisheye = true, .k1 = p[4], .k2 = p[5], .k3 = p[6], .k4 = p[7]};
    case kSimpleRadialFisheye:
      return {.fisheye = true, .k1 = p[3]};
    case kRadialFisheye:
      return {.fisheye = true, .k1 = p[3], .k2 = p[4]};
    default:
      return {.fisheye = camera.model == kSimpleFisheye || camera.model == kFisheye};
  }
}
bool HasOneFocalLength(std::int32_t model) {
  return model != kPinhole && model != kOpencv && model != kFullOpencv && model != kOpencvFisheye && model != kFisheye;
}

// Where COLMAP sees (u, v, 1), by the formulas of its documentation; pixels from the corner of the image.
Eigen::Vector2d SeenBy(const Camera& camera, double u, double v) {
  const Bend bend = BendOf(camera);
  const double r2 = u * u + v * v, theta = std::atan(std::sqrt(r2)), at = bend.fisheye ? theta * theta : r2;
  double radial = 1 + bend.k1 * at + bend.k2 * at * at + bend.k3 * at * at * at + bend.k4 * at * at * at * at;
  if (bend.fisheye && r2 > 0) radial *= theta / std::sqrt(r2);
  const double x = u * radial + 2 * bend.p1 * u * v + bend.p2 * (r2 + 2 * u * u);
  const double y = v * radial + 2 * bend.p2 * u * v + bend.p1 * (r2 + 2 * v * v);
  const std::vector<double>& p = camera.parameters;
  if (HasOneFocalLength(camera.model)) return {p[0] * x + p[1], p[0] * y + p[2]};
  return {p[0] * x + p[2], p[1] * y + p[3]};
}

// Where we see it; of a pinhole after undistorting.
Eigen::Vector2d UndistortedPlace(const CameraSettings& settings, const Eigen::Vector2d& pixel) {
  if (settings.camera.model == CameraModel::kPinhole) return Undistorted(settings, pixel);
  const std::vector<float>& p = settings.camera.parameters;
  const Eigen::Vector3f ray = Unproject(settings.camera, pixel.cast<float>());
  return {p[0] * ray.x() + p[2], p[1] * ray.y() + p[3]};
}

constexpr std::array kAlike = {kSimplePinhole, kPinhole,       kSimpleRadial,  kRadial,
                               kOpencv,        kFullOpencv,    kOpencvFisheye, kSimpleRadialFisheye,
                               kRadialFisheye, kSimpleFisheye, kFisheye};

Camera SomeCamera(std::int32_t model) {
  const std::size_t count = kCameraModels[static_cast<std::size_t>(model)].parameters;
  std::vector<double> parameters =
      HasOneFocalLength(model) ? std::vector<double>{400, 321, 243} : std::vector<double>{400, 410, 321, 243};
  for (const double k : {-0.03, 0.01, 0.001, -0.002, 0.003}) parameters.push_back(k);
  parameters.resize(count, 0);
  return Of(model, parameters);
}

// Of every model that is like one of ours: what it sees, we see half a pixel up and left of it; so does what is
// written.
TEST(ColmapLenses, SeeWhereOursSee) {
  for (const std::int32_t model : kAlike) {
    const Camera read = SomeCamera(model);
    ASSERT_EQ(WhyNotRead(read), nullptr);
    const CameraSettings settings = SettingsOf(read, CameraId(0));
    const std::vector<float>& p = settings.camera.parameters;
    const Camera written = CameraOf(settings, 1);
    for (double u = -0.5; u <= 0.5; u += 0.125)
      for (double v = -0.4375; v <= 0.5; v += 0.125) {
        const Eigen::Vector2d seen = SeenBy(read, u, v), wanted(p[0] * u + p[2], p[1] * v + p[3]);
        const Eigen::Vector2d place = UndistortedPlace(settings, seen - Eigen::Vector2d(0.5, 0.5));
        EXPECT_LT((place - wanted).norm(), 0.01) << model << " " << u << " " << v;
        EXPECT_LT((SeenBy(written, u, v) - seen).norm(), 1e-4) << model;
      }
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
      {kThinPrismFisheye,
       {0.1, 0.01, 0.001, -0.002, 0.003, 0.0004, 0.005, -0.006},
       0.5478682327789625,
       0.27166476744486256}};
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
