// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/possible.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>

#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kNone = {kNan, kInfinity, -kInfinity, 1e39, -1e300};  // beyond what a 32-bit float holds

TEST(Possible, PositionsAreFiniteInSinglePrecision) {
  EXPECT_THAT(WhyNoPosition({0, 0, 0}), IsEmpty());
  EXPECT_THAT(WhyNoPosition({-6.4e6, 1e9, 4}), IsEmpty());
  for (const double number : kNone)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_THAT(WhyNoPosition(Eigen::Vector3d::Unit(axis) * number), HasSubstr("is not finite")) << number;
  EXPECT_THAT(WhyNoPosition({0, kNan, 2}), HasSubstr("the position 0 nan 2 "));
}

TEST(Possible, QuaternionsAreRotationsOfAnyLength) {
  for (const double length : {1.0, 0.01, 1e5})
    EXPECT_THAT(WhyNoPose(Eigen::Quaterniond(length, 0, 0, 0), {0, 0, 0}), IsEmpty()) << length;
  EXPECT_THAT(WhyNoPose(Eigen::Quaterniond(0, 0, 0, 0), {0, 0, 0}), HasSubstr("the quaternion 0 0 0 0"));
  for (const double number : kNone)
    EXPECT_THAT(WhyNoPose(Eigen::Quaterniond(1, 0, number, 0), {0, 0, 0}), HasSubstr("is no rotation")) << number;
  EXPECT_THAT(WhyNoPose(Eigen::Quaterniond(1, 0, 0, 0), {0, 0, kInfinity}), HasSubstr("the position"));
}

TEST(Possible, MatricesAreRotations) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d quarter;  // about z
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  for (const Eigen::Matrix3d& rotation : {identity, quarter, Eigen::Matrix3d(1.0001 * quarter)})
    EXPECT_THAT(WhyNoPose(rotation, {0, 0, 0}), IsEmpty());
  for (const double factor : {0.0, 0.5, -1.0, 2.0, kNan, kInfinity})
    EXPECT_THAT(WhyNoPose(Eigen::Matrix3d(factor * identity), {0, 0, 0}), HasSubstr("is no rotation")) << factor;
  EXPECT_THAT(WhyNoPose(identity, {kNan, 0, 0}), HasSubstr("the position nan 0 0"));
}

TEST(Possible, ScalesAreAbove0) {
  EXPECT_THAT(WhyNoScale(0.001), IsEmpty());
  for (const double scale : {0.0, -1.0, kNan, kInfinity, 1e39, 1e-39})
    EXPECT_THAT(WhyNoScale(scale), HasSubstr("the scale")) << scale;
}

TEST(Possible, CamerasHaveFocalLengths) {
  const std::array<double, 3> others = {320, -240, 0};
  EXPECT_THAT(WhyNoCamera(500, 0.5, others), IsEmpty());
  for (const double length : {0.0, -500.0, kNan, kInfinity, 1e39, 1e-39}) {
    EXPECT_THAT(WhyNoCamera(length, 500, others), HasSubstr("the focal lengths")) << length;
    EXPECT_THAT(WhyNoCameraOrNone(500, length, others), HasSubstr("the focal lengths")) << length;
  }
  EXPECT_THAT(WhyNoCameraOrNone(0, 0, std::array{0.0, 0.0}), IsEmpty());
  EXPECT_THAT(WhyNoCameraOrNone(0, 0, others), HasSubstr("the focal lengths 0 0 "));
  for (const double number : kNone) {
    EXPECT_THAT(WhyNoCamera(500, 500, std::array{0.0, number}), HasSubstr("the camera's numbers")) << number;
    EXPECT_THAT(WhyNoCameraOrNone(0, 0, std::array{0.0, number}), HasSubstr("the focal lengths")) << number;
  }
}

TEST(Possible, ImagesHaveASize) {
  EXPECT_THAT(WhyNoImageSize(1, 1 << 20), IsEmpty());
  for (const double side : {0.0, -1.0, kNan, kInfinity, 1048577.0}) {
    EXPECT_THAT(WhyNoImageSize(side, 480), HasSubstr("are impossible")) << side;
    EXPECT_THAT(WhyNoImageSize(640, side), HasSubstr("are impossible")) << side;
  }
}

TEST(Possible, WhatIsAPoseIsOneOfTheModel) {
  const Rigid3f pose = PoseOf(Eigen::Quaterniond(0, 3, 4, 0), Eigen::Vector3d(1, 2, 1e9));
  EXPECT_TRUE(IsPose(pose));
  EXPECT_EQ(pose.rotation.coeffs(), Eigen::Vector4f(0.6F, 0.8F, 0, 0));
  const Eigen::Quaterniond nearly(1.0000001, 0, 0, 0);  // keeps its bits
  EXPECT_EQ(PoseOf(nearly, Eigen::Vector3d::Zero()).rotation.w(), 1.0000001F);
}

TEST(IsPose, RotationsAreOffByNoMoreThanAFactor) {
  EXPECT_TRUE(IsRotation(Quaternionf(1, 1, 0, 0)));
  EXPECT_TRUE(IsRotation(Quaternionf(0.5F, 0, 0, 0)));
  for (const float number : {0.F, 0.4F, 3.F, 1e30F, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_FALSE(IsRotation(Quaternionf(number, 0, 0, 0))) << number;
  EXPECT_FALSE(IsPose(Rigid3f{Quaternionf::Identity(), {0, std::numeric_limits<float>::infinity(), 0}}));
  EXPECT_FALSE(IsPose(Similarity3d{.scale = 0}));
  EXPECT_FALSE(IsPose(Similarity3d{.translation = {1e39, 0, 0}}));
  EXPECT_TRUE(IsPose(Similarity3d{.scale = 0.5}));
}

}  // namespace
}  // namespace slamdb::detail
