// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/derive.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::IsEmpty;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Camera MakeCamera(CameraModel model, std::vector<float> parameters) {
  Camera camera;
  camera.model = model;
  camera.parameters = std::move(parameters);
  return camera;
}

const Camera kPinhole = MakeCamera(CameraModel::kPinhole, {500, 400, 320, 240});
const Camera kFisheye = MakeCamera(CameraModel::kKannalaBrandt8, {200, 210, 320, 240, 0.01F, -0.02F, 0.003F, 0.0004F});

Keypoint KeypointAt(float x, float y, std::int32_t octave = 0) {
  return {.angle = 0, .response = 0, .size = 31, .x = x, .y = y, .class_id = -1, .octave = octave};
}

// 10 x 10 cells of 8 x 8 pixels.
ImageBounds SmallBounds() {
  return {.grid_columns = 10,
          .grid_rows = 10,
          .inverse_cell_width = 0.125F,
          .inverse_cell_height = 0.125F,
          .min_x = 0,
          .min_y = 0,
          .max_x = 80,
          .max_y = 80};
}

TEST(Project, PinholeAsComputedByHand) {
  const auto pixel = Project(kPinhole, {1, -2, 4});
  ASSERT_TRUE(pixel);
  EXPECT_FLOAT_EQ(pixel->x(), 500.0F / 4 + 320);
  EXPECT_FLOAT_EQ(pixel->y(), -2 * 400.0F / 4 + 240);
}

TEST(Project, PinholeSeesNothingBehindItself) {
  EXPECT_FALSE(Project(kPinhole, {1, 1, 0}));
  EXPECT_FALSE(Project(kPinhole, {1, 1, -1}));
  EXPECT_FALSE(Project(kPinhole, {1, 1, kNan}));
}

TEST(Project, KannalaBrandtAsComputedByHand) {
  // A ray 45 degrees off the axis, to the right: theta = pi / 4.
  const double t = std::numbers::pi / 4;
  const double radius =
      t + 0.01 * std::pow(t, 3) - 0.02 * std::pow(t, 5) + 0.003 * std::pow(t, 7) + 0.0004 * std::pow(t, 9);
  const auto pixel = Project(kFisheye, {3, 0, 3});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 200 * radius + 320, 1e-3);
  EXPECT_NEAR(pixel->y(), 240, 1e-4);
}

TEST(Project, KannalaBrandtSeesTheAxisAndSideways) {
  EXPECT_EQ(*Project(kFisheye, {0, 0, 2}), Eigen::Vector2f(320, 240));
  const auto sideways = Project(kFisheye, {0, 1, 0});
  ASSERT_TRUE(sideways);
  EXPECT_GT(sideways->y(), 240 + 210 * 1.4F);
}

TEST(Project, NeedsTheParametersOfItsModel) {
  EXPECT_FALSE(Project(MakeCamera(CameraModel::kPinhole, {500, 400, 320}), {0, 0, 1}));
  EXPECT_FALSE(Project(MakeCamera(CameraModel::kKannalaBrandt8, {500, 400, 320, 240}), {0, 0, 1}));
  EXPECT_FALSE(Project(MakeCamera(static_cast<CameraModel>(7), {500, 400, 320, 240}), {0, 0, 1}));
}

TEST(Unproject, UndoesProject) {
  for (const Camera& camera : {kPinhole, kFisheye}) {
    for (const Eigen::Vector3f& ray : {Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(0.3F, -0.2F, 1),
                                       Eigen::Vector3f(-1, 0.7F, 1), Eigen::Vector3f(1.5F, 1.2F, 1)}) {
      const Eigen::Vector3f found = Unproject(camera, *Project(camera, ray * 3));
      EXPECT_LT((found - ray).norm(), 2e-4F) << ray.transpose();
    }
  }
}

TEST(CameraCenter, IsWhereTheCameraStands) {
  KeyFrame keyframe;
  // The camera looks along the world's x axis from (1, 2, 3); its y axis points down the world's z.
  Eigen::Matrix3f world_from_camera;
  world_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Quaternionf rotation(Eigen::Matrix3f(world_from_camera.transpose()));
  keyframe.camera_from_world = {rotation, -(rotation * Eigen::Vector3f(1, 2, 3))};
  keyframe.left_from_right.translation = {0.1F, 0, 0};
  EXPECT_LT((CameraCenter(keyframe) - Eigen::Vector3f(1, 2, 3)).norm(), 1e-6F);
  EXPECT_LT((RightCameraCenter(keyframe) - Eigen::Vector3f(1, 1.9F, 3)).norm(), 1e-6F);
  keyframe.camera_from_world.rotation.coeffs() *= 1.5F;  // as recorded, not of unit length
  EXPECT_LT((CameraCenter(keyframe) - Eigen::Vector3f(1, 2, 3)).norm(), 1e-5F);
}

TEST(WorldFromBody, TakesTheCalibrationWhereThereIsOne) {
  KeyFrame keyframe;
  keyframe.camera_from_world.translation = {-1, -2, -3};
  keyframe.imu_calibration.camera_from_body.translation = {0, 0, 0.5F};
  EXPECT_EQ(WorldFromBody(keyframe).translation, Eigen::Vector3f(1, 2, 3));
  keyframe.imu_calibration.is_set = true;
  EXPECT_EQ(WorldFromBody(keyframe).translation, Eigen::Vector3f(1, 2, 3.5F));
}

KeyFrame TwoCameraKeyFrame() {
  KeyFrame keyframe;
  keyframe.right_camera = CameraId(1);
  keyframe.features.count = 3;
  keyframe.features.left_count = 2;
  keyframe.features.right_count = 1;
  keyframe.features.keypoints = {KeypointAt(1, 1), KeypointAt(2, 2)};
  keyframe.features.undistorted = {KeypointAt(11, 1), KeypointAt(12, 2)};
  keyframe.features.right_keypoints = {KeypointAt(3, 3)};
  keyframe.features.right_x = {-1, -1};
  return keyframe;
}

TEST(ObservedKeypoint, IsUndistortedInOneCameraKeyframes) {
  KeyFrame keyframe;
  keyframe.features.keypoints = {KeypointAt(1, 1)};
  keyframe.features.undistorted = {KeypointAt(11, 1)};
  EXPECT_EQ(ObservedKeypoint(keyframe, 0), keyframe.features.undistorted.data());
  EXPECT_EQ(ObservedKeypoint(keyframe, 1), nullptr);
  EXPECT_EQ(ObservedKeypoint(keyframe, -1), nullptr);
  EXPECT_EQ(ObservedKeypoint(keyframe, Observation::kAbsent), nullptr);
}

TEST(ObservedKeypoint, IsAsDetectedInEitherImageOfAFisheyePair) {
  const KeyFrame keyframe = TwoCameraKeyFrame();
  EXPECT_EQ(ObservedKeypoint(keyframe, 1), &keyframe.features.keypoints[1]);
  EXPECT_EQ(ObservedKeypoint(keyframe, 2), &keyframe.features.right_keypoints[0]);
  EXPECT_EQ(ObservedKeypoint(keyframe, 3), nullptr);
}

TEST(ObservationWeight, CountsDepthTwiceAndEachFisheyeImageOnce) {
  KeyFrame keyframe;
  keyframe.features.right_x = {-1, 0, 55};
  EXPECT_EQ(ObservationWeight(keyframe, {KeyFrameId(0), 0, -1}), 1);
  EXPECT_EQ(ObservationWeight(keyframe, {KeyFrameId(0), 1, -1}), 2);
  EXPECT_EQ(ObservationWeight(keyframe, {KeyFrameId(0), 2, -1}), 2);
  EXPECT_EQ(ObservationWeight(keyframe, {KeyFrameId(0), 3, -1}), 1) << "a row outside the column";
  EXPECT_EQ(ObservationWeight(keyframe, {KeyFrameId(0), Observation::kAbsent, -1}), 0);

  KeyFrame pair = TwoCameraKeyFrame();
  pair.features.right_x = {5, 5};
  EXPECT_EQ(ObservationWeight(pair, {KeyFrameId(0), 0, -1}), 1);
  EXPECT_EQ(ObservationWeight(pair, {KeyFrameId(0), -1, 2}), 1);
  EXPECT_EQ(ObservationWeight(pair, {KeyFrameId(0), 0, 2}), 2);
}

Descriptor WithBits(std::initializer_list<int> bits) {
  Descriptor descriptor{};
  for (const int bit : bits) descriptor[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(1 << bit % 8);
  return descriptor;
}

// `count` bits set, from the first on.
Descriptor WithCount(int count) {
  Descriptor descriptor{};
  for (int bit = 0; bit < count; ++bit)
    descriptor[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(1 << bit % 8);
  return descriptor;
}

TEST(HammingDistance, CountsDifferingBits) {
  Descriptor all;
  all.fill(0xFF);
  EXPECT_EQ(HammingDistance({}, {}), 0);
  EXPECT_EQ(HammingDistance({}, all), 256);
  EXPECT_EQ(HammingDistance(WithBits({0, 9, 255}), WithBits({9, 128})), 3);
}

// The distance of WithCount(a) and WithCount(b) is |a - b|, so medians are easy to see.
TEST(MostDistinctiveDescriptor, HasTheLeastMedianDistance) {
  const auto best = [](const std::vector<int>& counts) {
    std::vector<Descriptor> descriptors;
    for (const int count : counts) descriptors.push_back(WithCount(count));
    return MostDistinctiveDescriptor(descriptors);
  };
  EXPECT_EQ(best({7}), 0U);
  EXPECT_EQ(best({200, 0}), 0U) << "element 0 of two is the own distance, 0, for both";
  EXPECT_EQ(best({0, 100, 110}), 1U) << "element 1 of three: 100, 10, 10";
  EXPECT_EQ(best({0, 200, 100, 104}), 2U) << "element 1 of four: 100, 96, 4, 4";
  EXPECT_EQ(best({0, 250, 90, 100, 109}), 3U) << "element 2 of five: 100, 150, 19, 10, 19";
  EXPECT_EQ(best({50, 50, 50}), 0U) << "the first of equals";
}

TEST(DeriveGrid, RoundsToTheNearestCellAsOrbSlam3Does) {
  // 3.9 / 8 rounds to 0, 4 / 8 to 1, 75.9 / 8 = 9.4875 to 9, 76 / 8 = 9.5 to 10: outside.
  const Column<Keypoint> keypoints = {KeypointAt(3.9F, 0),  KeypointAt(4, 0),  KeypointAt(75.9F, 0), KeypointAt(76, 0),
                                      KeypointAt(-3.9F, 0), KeypointAt(-4, 0), KeypointAt(0, kNan),  KeypointAt(1, 2)};
  const FeatureGrid grid = DeriveGrid(keypoints, SmallBounds());
  EXPECT_EQ(grid.column_sizes, Column<std::uint32_t>(10, 10));
  ASSERT_EQ(grid.cell_sizes.size(), 100U);
  EXPECT_EQ(grid.cell_sizes[0], 3U);
  EXPECT_EQ(grid.cell_sizes[10], 1U);
  EXPECT_EQ(grid.cell_sizes[90], 1U);
  EXPECT_THAT(grid.keypoints, ElementsAre(0, 4, 7, 1, 2)) << "row order within a cell, column after column";
}

TEST(DeriveGrid, RoundsLikeStdRound) {
  ImageBounds bounds = SmallBounds();
  bounds.inverse_cell_width = bounds.inverse_cell_height = 1;
  for (const float x : {0.49999997F, 0.5F, 1.4999999F, 1.5F, 2.5F, 8.5F, 9.499999F, 9.5F, -0.4999F}) {
    const FeatureGrid grid = DeriveGrid({KeypointAt(x, 0)}, bounds);
    const auto expected = static_cast<int>(std::round(x));
    for (int column = 0; column < 10; ++column)
      EXPECT_EQ(grid.cell_sizes[static_cast<std::size_t>(column * 10)], column == expected ? 1U : 0U) << x;
  }
}

TEST(DeriveGrid, StartsAtTheImageBounds) {
  ImageBounds bounds = SmallBounds();
  bounds.min_x = -16;
  bounds.min_y = 8;
  const FeatureGrid grid = DeriveGrid({KeypointAt(0, 24)}, bounds);
  EXPECT_EQ(grid.cell_sizes[2 * 10 + 2], 1U);
}

TEST(DeriveGrid, MakesNoneOfImpossibleBounds) {
  for (const auto& [columns, rows] : {std::pair(0, 10), std::pair(10, -1), std::pair(1 << 30, 1 << 30)}) {
    ImageBounds bounds = SmallBounds();
    bounds.grid_columns = columns;
    bounds.grid_rows = rows;
    const FeatureGrid grid = DeriveGrid({KeypointAt(1, 1)}, bounds);
    EXPECT_TRUE(grid.empty());
    EXPECT_THAT(grid.keypoints, IsEmpty());
    EXPECT_TRUE(IsDerivedGrid(grid, {KeypointAt(1, 1)}, bounds));
  }
}

TEST(IsDerivedGrid, KnowsTheDerivedGridFromAllOthers) {
  const Column<Keypoint> keypoints = {KeypointAt(1, 1), KeypointAt(50, 60), KeypointAt(2, 1), KeypointAt(500, 1)};
  const FeatureGrid derived = DeriveGrid(keypoints, SmallBounds());
  EXPECT_TRUE(IsDerivedGrid(derived, keypoints, SmallBounds()));
  const auto is_derived_after = [&](auto change) {
    FeatureGrid grid = derived;
    change(grid);
    return IsDerivedGrid(grid, keypoints, SmallBounds());
  };
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g = {}; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { std::swap(g.keypoints[0], g.keypoints[1]); }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { std::swap(g.keypoints[0], g.keypoints[2]); }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.keypoints[1] = 0; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.keypoints[1] = 1000; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.keypoints.pop_back(); }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.keypoints.push_back(3); }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.cell_sizes[0] = ~0U; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { --g.cell_sizes[0], ++g.cell_sizes[1]; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { --g.cell_sizes[0], g.keypoints.erase(g.keypoints.begin()); }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.column_sizes[3] = 9; }));
  EXPECT_FALSE(is_derived_after([](FeatureGrid& g) { g.column_sizes.push_back(10), g.cell_sizes.resize(110, 0); }));
}

TEST(DerivePyramid, MultipliesInFloat) {
  const ScalePyramid pyramid = DerivePyramid(4, 1.2F);
  EXPECT_EQ(pyramid.levels, 4);
  EXPECT_EQ(pyramid.factor, 1.2F);
  EXPECT_FLOAT_EQ(pyramid.log_factor, 0.18232156F);
  EXPECT_THAT(pyramid.factors, ElementsAre(1.0F, 1.2F, 1.2F * 1.2F, 1.2F * 1.2F * 1.2F));
  EXPECT_THAT(pyramid.sigma2, ElementsAre(1.0F, FloatEq(1.44F), FloatEq(2.0736F), FloatEq(2.985984F)));
  EXPECT_THAT(pyramid.inverse_sigma2,
              ElementsAre(1.0F, FloatEq(1 / 1.44F), FloatEq(1 / 2.0736F), FloatEq(0.33489797F)));
  EXPECT_THAT(DerivePyramid(0, 1.2F).factors, IsEmpty());
}

TEST(DeriveDistanceRange, ReachesFromTheFinestToTheCoarsestLevel) {
  const ScalePyramid pyramid = DerivePyramid(8, 1.2F);
  const DistanceRange range = DeriveDistanceRange(10, 2, pyramid);
  EXPECT_FLOAT_EQ(range.max, 14.4F);
  EXPECT_FLOAT_EQ(range.min, 14.4F / 3.5831808F);
  EXPECT_EQ(DeriveDistanceRange(10, 8, pyramid).max, 0);
  EXPECT_EQ(DeriveDistanceRange(10, -1, pyramid).max, 0);
}

}  // namespace
}  // namespace slamdb
