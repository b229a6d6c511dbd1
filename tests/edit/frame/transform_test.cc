// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/transform.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Kind {
  const char* name;
  Sensor sensor;
  bool inertial;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

Atlas Small(const Kind& kind) {
  SyntheticOptions options;
  options.sensor = kind.sensor;
  options.inertial = kind.inertial;
  options.keyframes = 8;
  options.points = 200;
  options.features = 250;
  return SynthesizeAtlas(options);
}

Similarity3d Motion(double scale) {
  return {scale, Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized(), {3, -20, 7.5}};
}

// The same but for float noise: poses, points and lengths within `tolerance` of their size.
void ExpectNear(const Map& actual, const Map& expected, double tolerance) {
  const auto near = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return (a - b).norm() <= tolerance * std::max(1.0F, b.norm());
  };
  for (std::size_t row = 0; row < expected.keyframes.size(); ++row) {
    const KeyFrame &a = actual.keyframes[row], &b = expected.keyframes[row];
    EXPECT_LE(a.camera_from_world.rotation.angularDistance(b.camera_from_world.rotation), tolerance);
    EXPECT_TRUE(near(a.camera_from_world.translation, b.camera_from_world.translation)) << row;
    EXPECT_TRUE(near(a.velocity, b.velocity)) << row;
    EXPECT_TRUE(near(a.body_position, b.body_position)) << row;
    EXPECT_TRUE(near(a.left_from_right.translation, b.left_from_right.translation)) << row;
    EXPECT_NEAR(a.intrinsics.baseline_fx, b.intrinsics.baseline_fx, tolerance * 100);
    EXPECT_NEAR(a.intrinsics.depth_threshold, b.intrinsics.depth_threshold, tolerance * 100);
    EXPECT_NEAR(a.merge_scale, b.merge_scale, tolerance);
  }
  for (std::size_t row = 0; row < expected.points.size(); ++row) {
    const MapPoint &a = actual.points[row], &b = expected.points[row];
    EXPECT_TRUE(near(a.position, b.position)) << row;
    EXPECT_TRUE(near(a.normal, b.normal)) << row;
    EXPECT_NEAR(a.min_distance, b.min_distance, tolerance * b.min_distance);
    EXPECT_NEAR(a.max_distance, b.max_distance, tolerance * b.max_distance);
  }
}

class TransformMapOf : public ::testing::TestWithParam<Kind> {
 protected:
  const Atlas before_ = Small(GetParam());
};

TEST_P(TransformMapOf, IdentityChangesNoByte) {
  Atlas atlas = before_;
  TransformMap(atlas.maps[0], Similarity3d{});
  EXPECT_THAT(atlas, EqualsAtlas(before_));
}

TEST_P(TransformMapOf, ThereAndBackIsTheSame) {
  for (const double scale : {1.0, 0.25, 3.3}) {
    Atlas atlas = before_;
    for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.merge_scale = 1.5F;
    const Atlas expected = atlas;
    TransformMap(atlas.maps[0], Motion(scale));
    for (std::size_t row = 0; row < atlas.maps[0].keyframes.size(); ++row) {
      const KeyFrame &there = atlas.maps[0].keyframes[row], &here = expected.maps[0].keyframes[row];
      EXPECT_NEAR(there.merge_scale, 1.5 / scale, 1e-6);
      EXPECT_LT((CameraCenter(there).cast<double>() - Motion(scale) * CameraCenter(here).cast<double>()).norm(), 1e-3);
    }
    TransformMap(atlas.maps[0], Motion(scale).Inverse());
    ExpectNear(atlas.maps[0], expected.maps[0], 1e-5);
  }
}

// And what is there in between is not what it was.
TEST_P(TransformMapOf, MergeScalesAreDividedByTheScale) {
  Atlas atlas = before_;
  atlas.maps[0].keyframes[0].merge_scale = 1.5F;
  TransformMap(atlas.maps[0], Motion(3));
  EXPECT_EQ(atlas.maps[0].keyframes[0].merge_scale, 0.5F);
  TransformMap(atlas.maps[0], Motion(1));
  EXPECT_EQ(atlas.maps[0].keyframes[0].merge_scale, 0.5F) << "a motion without scale";
}

TEST_P(TransformMapOf, LandmarksMoveAsPointsDo) {
  Atlas atlas = before_;
  MakeLandmarks(atlas, {});
  const std::vector<Landmark> before = atlas.maps[0].landmarks;
  ASSERT_FALSE(before.empty());
  const Similarity3d motion = Motion(2);
  const Eigen::Matrix3d turn = motion.rotation.toRotationMatrix();
  TransformMap(atlas.maps[0], motion);
  ASSERT_EQ(atlas.maps[0].landmarks.size(), before.size());
  for (std::size_t row = 0; row < before.size(); ++row) {
    const Landmark& landmark = atlas.maps[0].landmarks[row];
    EXPECT_LT((landmark.mean - motion * before[row].mean).norm(), 1e-9);
    EXPECT_LT((landmark.normal - turn * before[row].normal).norm(), 1e-9);
    const Eigen::Matrix3d covariance = before[row].pose().covariance;
    EXPECT_LT((landmark.pose().covariance - 4 * turn * covariance * turn.transpose()).norm(),
              1e-6 * (1e-12 + covariance.norm()));
    EXPECT_LT((landmark.mean - atlas.maps[0].points[row].position.cast<double>()).norm(), 1e-4);
  }
}

TEST_P(TransformMapOf, PointsStayAtTheirPixels) {
  for (const double scale : {1.0, 0.01, 50.0}) {
    Atlas atlas = before_;
    TransformMap(atlas.maps[0], Motion(scale));
    const MapStatistics before = ComputeStatistics(before_).maps[0], after = ComputeStatistics(atlas).maps[0];
    EXPECT_EQ(after.reprojection_error.count, before.reprojection_error.count);
    EXPECT_NEAR(after.reprojection_error.mean, before.reprojection_error.mean, 2e-2);
    EXPECT_NEAR(after.reprojection_error.max, before.reprojection_error.max, 0.3);
    EXPECT_NEAR(after.trajectory_length, scale * before.trajectory_length, 1e-4 * scale * before.trajectory_length);
  }
}

TEST_P(TransformMapOf, DepthsAndDisparitiesAgree) {
  Atlas atlas = before_;
  TransformMap(atlas.maps[0], Motion(2));
  for (std::size_t row = 0; row < atlas.maps[0].keyframes.size(); ++row) {
    const KeyFrame &a = atlas.maps[0].keyframes[row], &b = before_.maps[0].keyframes[row];
    EXPECT_EQ(a.intrinsics.baseline_fx, 2 * b.intrinsics.baseline_fx);
    EXPECT_EQ(a.intrinsics.baseline, 2 * b.intrinsics.baseline);
    EXPECT_EQ(a.half_baseline, 2 * b.half_baseline);
    EXPECT_EQ(a.left_from_right.translation, Eigen::Vector3f(2 * b.left_from_right.translation));
    ASSERT_EQ(a.features.depth.size(), b.features.depth.size());
    for (std::size_t i = 0; i < a.features.depth.size(); ++i)
      EXPECT_EQ(a.features.depth[i], b.features.depth[i] > 0 ? 2 * b.features.depth[i] : b.features.depth[i]);
    EXPECT_EQ(a.features.right_x, b.features.right_x);
  }
}

TEST_P(TransformMapOf, ResultIsSound) {
  for (const double scale : {1.0, 3.0}) {
    Atlas atlas = before_;
    TransformMap(atlas.maps[0], Motion(scale));
    for (const RuleResult& result : CheckAtlas(atlas, {}).results)
      EXPECT_EQ(result.severity, Severity::kNote) << result.id;
  }
}

TEST_P(TransformMapOf, ThreadsDoNotMatter) {
  Atlas one = before_, many = before_;
  TransformMap(one.maps[0], Motion(1.1), 1);
  TransformMap(many.maps[0], Motion(1.1), 4);
  EXPECT_THAT(many, EqualsAtlas(one));
}

TEST_P(TransformMapOf, WhatTheImuMeasuredStays) {
  Atlas atlas = before_;
  TransformMap(atlas.maps[0], Motion(2));
  for (std::size_t row = 0; row < atlas.maps[0].keyframes.size(); ++row) {
    KeyFrame a = before_.maps[0].keyframes[row];
    const KeyFrame& b = atlas.maps[0].keyframes[row];
    EXPECT_EQ(a.preintegration.velocity, b.preintegration.velocity);
    EXPECT_EQ(a.preintegration.position, b.preintegration.position);
    EXPECT_EQ(a.imu_bias.accelerometer, b.imu_bias.accelerometer);
    EXPECT_EQ(a.imu_calibration.camera_from_body.translation, b.imu_calibration.camera_from_body.translation);
    if (b.imu_calibration.is_set) {
      EXPECT_LT((WorldFromBody(b).translation - b.body_position).norm(), 1e-4);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, TransformMapOf,
                         ::testing::Values(Kind{"monocular", Sensor::kMonocular, false},
                                           Kind{"stereo", Sensor::kStereo, false}, Kind{"rgbd", Sensor::kRgbd, false},
                                           Kind{"fisheye", Sensor::kFisheyeStereo, false},
                                           Kind{"mono_inertial", Sensor::kMonocular, true},
                                           Kind{"stereo_inertial", Sensor::kStereo, true}));

TEST(TransformMap, ByHand) {
  Map map;
  KeyFrame& keyframe = map.keyframes.emplace_back();
  keyframe.camera_from_world.translation = {-1, 0, 0};  // the camera is at (1, 0, 0)
  keyframe.velocity = {1, 0, 0};
  MapPoint& point = map.points.emplace_back();
  point.position = {1, 0, 4};
  point.normal = {0, 0, 1};
  point.min_distance = 1;
  point.max_distance = 6;
  // A quarter turn about z takes x to y and y to -x.
  const double half = std::sqrt(0.5);
  TransformMap(map, {2, Eigen::Quaterniond(half, 0, 0, half), {10, 20, 30}});
  EXPECT_LT((CameraCenter(map.keyframes[0]) - Eigen::Vector3f(10, 22, 30)).norm(), 1e-5);
  EXPECT_LT((map.keyframes[0].velocity - Eigen::Vector3f(0, 2, 0)).norm(), 1e-6);
  EXPECT_LT((map.points[0].position - Eigen::Vector3f(10, 22, 38)).norm(), 1e-5);
  EXPECT_LT((map.points[0].normal - Eigen::Vector3f(0, 0, 1)).norm(), 1e-6);
  EXPECT_EQ(map.points[0].min_distance, 2);
  EXPECT_EQ(map.points[0].max_distance, 12);
}

TEST(TransformMap, UninitialisedFieldsStayAsRecorded) {
  Map map;
  KeyFrame& keyframe = map.keyframes.emplace_back();
  const std::uint32_t payload = 0x7FC12345;  // a NaN
  std::memcpy(&keyframe.merge_scale, &payload, sizeof payload);
  keyframe.body_position.setConstant(keyframe.merge_scale);
  keyframe.velocity.setConstant(-0.0F);
  keyframe.preintegration.position.setConstant(keyframe.merge_scale);
  map.keyframes.push_back(keyframe);
  map.keyframes[1].merge_scale = 1e-30F;
  map.keyframes[1].body_position = {1e30F, 2, 3};  // without calibration it is garbage, too
  Atlas atlas, expected;
  atlas.maps.push_back(map);
  expected = atlas;
  TransformMap(atlas.maps[0], Motion(2));
  for (std::size_t row = 0; row < 2; ++row)
    atlas.maps[0].keyframes[row].camera_from_world = expected.maps[0].keyframes[row].camera_from_world;
  EXPECT_THAT(atlas, EqualsAtlas(expected));
}

TEST(TransformMap, BadTransformsAreRefusedBeforeAnythingMoves) {
  const Atlas before = Small({"", Sensor::kMonocular, false});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Similarity3d> bad = {{.scale = 0},
                                         {.scale = -1},
                                         {.scale = nan},
                                         {.scale = INFINITY},
                                         {.translation = {0, nan, 0}},
                                         {.rotation = Eigen::Quaterniond(0, 0, 0, 0)},
                                         {.rotation = Eigen::Quaterniond(nan, 0, 0, 1)},
                                         {.translation = {1e39, 0, 0}}};
  for (const Similarity3d& transform : bad) {
    Atlas atlas = before;
    EXPECT_THROW(TransformMap(atlas.maps[0], transform), Error);
    EXPECT_THAT(atlas, EqualsAtlas(before));
  }
}

TEST(TransformWarnings, TellOfTiltScaleAndCoarseFloats) {
  const Map plain = Small({"", Sensor::kMonocular, false}).maps[0];
  const Map inertial = Small({"", Sensor::kStereo, true}).maps[0];
  const Similarity3d tilt{.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()))};
  const Similarity3d yaw{.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()))};
  EXPECT_THAT(TransformWarnings(plain, tilt), IsEmpty());
  EXPECT_THAT(TransformWarnings(inertial, yaw), IsEmpty());
  EXPECT_THAT(TransformWarnings(inertial, tilt), ElementsAre(HasSubstr("gravity is tilted")));
  EXPECT_THAT(TransformWarnings(inertial, {.scale = 2}), ElementsAre(HasSubstr("scale changes by 2")));
  const Map stereo = Small({"", Sensor::kStereo, false}).maps[0];
  EXPECT_THAT(TransformWarnings(stereo, {.scale = 2}), ElementsAre(HasSubstr("the baseline changes along")));
  EXPECT_THAT(TransformWarnings(plain, {.scale = 2}), IsEmpty());
  EXPECT_THAT(CoarseningLoss(plain, {.translation = {4e5, 5e6, 0}}).value_or(""), HasSubstr("single precision"));
  EXPECT_FALSE(CoarseningLoss(plain, tilt));
  Map tilted = inertial;
  TransformMap(tilted, tilt);
  EXPECT_THAT(TransformWarnings(tilted, tilt.Inverse()), IsEmpty());
}

}  // namespace
}  // namespace slamdb
