// SPDX-License-Identifier: BSD-3-Clause
// Cameras in double: against the projection in float, and derivatives against differences.
#include "slamdb/model/detail/lens.h"

#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

using detail::Lens;

Camera CameraOf(CameraModel model, std::initializer_list<float> parameters) {
  Camera camera;
  camera.model = model;
  camera.parameters = parameters;
  return camera;
}

Camera Pinhole() { return CameraOf(CameraModel::kPinhole, {420, 421, 319.5F, 239.5F}); }
Camera Fisheye() {
  return CameraOf(CameraModel::kKannalaBrandt8, {281, 281.5F, 321.25F, 238.5F, 0.0035F, 0.0007F, -0.002F, 0.0002F});
}

class LensOf : public ::testing::TestWithParam<Camera (*)()> {
 protected:
  std::vector<Eigen::Vector3d> Points() const {
    std::vector<Eigen::Vector3d> points{{0, 0, 2},  {1e-9, 0, 1}, {0.3, -0.2, 1},
                                        {-2, 1, 3}, {5, 4, 0.5},  {1e-3, 2e-3, 9}};
    if (camera_.model == CameraModel::kKannalaBrandt8) points.emplace_back(3, 1, 0.01);
    return points;
  }

  Camera camera_ = GetParam()();
  Lens lens_ = Lens::Of(camera_).value();
};

TEST_P(LensOf, ProjectsAsTheModelDoes) {
  for (const Eigen::Vector3d& point : Points()) {
    Eigen::Vector2d pixel, again;
    Eigen::Matrix<double, 2, 3> by_point;
    ASSERT_TRUE(lens_.Project(point, pixel)) << point.transpose();
    ASSERT_TRUE(lens_.Project(point, again, by_point));
    EXPECT_EQ(pixel, again);
    const auto expected = Project(camera_, point.cast<float>());
    ASSERT_TRUE(expected);
    EXPECT_LT((pixel - expected->cast<double>()).norm(), 1e-4 * (1 + pixel.norm())) << point.transpose();
  }
}

TEST_P(LensOf, DerivativeIsThatOfDifferences) {
  for (const Eigen::Vector3d& point : Points()) {
    Eigen::Vector2d pixel, ahead, behind;
    Eigen::Matrix<double, 2, 3> by_point;
    ASSERT_TRUE(lens_.Project(point, pixel, by_point));
    const double step = 1e-6 * point.z();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d by = step * Eigen::Vector3d::Unit(axis);
      ASSERT_TRUE(lens_.Project(point + by, ahead) && lens_.Project(point - by, behind));
      const Eigen::Vector2d difference = (ahead - behind) / (2 * step);
      EXPECT_LT((difference - by_point.col(axis)).norm(), 1e-4 * (1 + by_point.norm()))
          << point.transpose() << " " << axis;
    }
  }
}

// A fisheye lens may see sideways and beyond, but nothing on the axis behind it.
TEST_P(LensOf, NothingBehindTheCamera) {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  std::vector<Eigen::Vector3d> unseen{{0, 0, -1},
                                      {0, 0, 0},
                                      {0, 0, std::numeric_limits<double>::quiet_NaN()},
                                      {1, 1, std::numeric_limits<double>::quiet_NaN()}};
  if (camera_.model == CameraModel::kPinhole) unseen.emplace_back(1, 1, 0);
  for (const Eigen::Vector3d& point : unseen) {
    EXPECT_FALSE(lens_.Project(point, pixel)) << point.transpose();
    EXPECT_FALSE(lens_.Project(point, pixel, by_point)) << point.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Models, LensOf, ::testing::Values(Pinhole, Fisheye));

TEST(Lens, IsNoneOfACameraThatCannotBe) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kPinhole, {420, 421, 319.5F})));
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kPinhole, {})));
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kPinhole, {0, 421, 319.5F, 239.5F})));
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kPinhole, {-420, 421, 319.5F, 239.5F})));
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kPinhole, {420, nan, 319.5F, 239.5F})));
  EXPECT_FALSE(Lens::Of(CameraOf(CameraModel::kKannalaBrandt8, {420, 421, 319.5F, 239.5F})));
}

}  // namespace
}  // namespace slamdb
