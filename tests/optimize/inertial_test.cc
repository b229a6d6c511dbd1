// SPDX-License-Identifier: BSD-3-Clause
// What the IMU measured, in bundle adjustment.
#include <gmock/gmock.h>

#include <numbers>

#include "slamdb/edit/frame/gravity.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/detail/inertial_links.h"
#include "tests/optimize/shaken.h"

namespace slamdb::testing {
namespace {

Atlas Truth() { return MakeTruth({"", Sensor::kMonocular, true}); }

// Turns a map about its initial camera.
void Tilt(Map& map, float radians) {
  const Quaternionf tilt(Eigen::AngleAxisf(radians, Eigen::Vector3f::UnitX()));
  for (KeyFrame& keyframe : map.keyframes) {
    const Eigen::Vector3f center = tilt * keyframe.camera_from_world.Center();
    keyframe.camera_from_world.rotation = keyframe.camera_from_world.rotation * tilt.conjugate();
    keyframe.camera_from_world.translation = -(keyframe.camera_from_world.rotation * center);
    keyframe.velocity = tilt * keyframe.velocity;
  }
  for (MapPoint& point : map.points) point.position = tilt * point.position;
}

TEST(InertialBundle, EstimatesVelocitiesFromWhatTheImuMeasured) {
  Atlas atlas = Truth();
  Map& map = atlas.maps[0];
  const Map truth = map;
  Shaker shaker;
  for (KeyFrame& keyframe : map.keyframes) keyframe.velocity += shaker.Step(0.3F);
  AdjustBundle(atlas, map.id);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row)
    EXPECT_LT((map.keyframes[row].velocity - truth.keyframes[row].velocity).norm(), 0.01F) << row;
}

TEST(InertialBundle, EstimatesBiasesAndRecordsThemAsOrbslam3Does) {
  Atlas atlas = Truth();
  Map& map = atlas.maps[0];
  const Map truth = map;
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.imu_bias.gyroscope += Eigen::Vector3f(0.01F, -0.01F, 0.005F);
    keyframe.imu_bias.accelerometer += Eigen::Vector3f(0.05F, 0.02F, -0.03F);
  }
  AdjustBundle(atlas, map.id);
  for (std::size_t row = 1; row < map.keyframes.size(); ++row) {
    const KeyFrame &keyframe = map.keyframes[row], &should = truth.keyframes[row];
    EXPECT_LT((keyframe.imu_bias.gyroscope - should.imu_bias.gyroscope).norm(), 1e-3F) << row;
    EXPECT_LT((keyframe.imu_bias.accelerometer - should.imu_bias.accelerometer).norm(), 0.05F) << row;
    const ImuPreintegration& imu = keyframe.preintegration;
    EXPECT_EQ(imu.updated_bias.gyroscope, keyframe.imu_bias.gyroscope);
    EXPECT_EQ(imu.updated_bias.accelerometer, keyframe.imu_bias.accelerometer);
    EXPECT_EQ((imu.bias_change.head<3>()), keyframe.imu_bias.gyroscope - imu.bias.gyroscope);
    EXPECT_EQ((imu.bias_change.tail<3>()), keyframe.imu_bias.accelerometer - imu.bias.accelerometer);
    // What was measured stays.
    EXPECT_EQ(imu.rotation, should.preintegration.rotation);
    EXPECT_EQ(imu.position, should.preintegration.position);
    EXPECT_EQ(imu.covariance, should.preintegration.covariance);
  }
}

TEST(InertialBundle, SetsUprightWhatIsTiltedALittle) {
  Atlas atlas = Truth();
  Map& map = atlas.maps[0];
  constexpr float kDegree = std::numbers::pi_v<float> / 180;
  Tilt(map, 2 * kDegree);
  const double before = UpByInertia(map)->z();
  AdjustBundle(atlas, map.id);
  EXPECT_LT(before, std::cos(1.9 * static_cast<double>(kDegree)));
  EXPECT_GT(UpByInertia(map)->z(), std::cos(0.1 * static_cast<double>(kDegree)));
}

TEST(InertialBundle, LeavesTheImuOutWhereGravityPointsElsewhere) {
  Atlas atlas = Truth();
  Tilt(atlas.maps[0], 1);
  EXPECT_FALSE(detail::KnowsGravity(atlas.maps[0]));
  const BundleReport report = AdjustBundle(atlas, atlas.maps[0].id);
  EXPECT_EQ(report.inertial_links, 0U);
}

TEST(InertialBundle, LeavesOutLinksThatCannotBe) {
  Atlas atlas = Truth();
  Map& map = atlas.maps[0];
  map.keyframes[2].preintegration.covariance.setConstant(std::numeric_limits<float>::quiet_NaN());
  map.keyframes[4].preintegration.duration = 0;
  map.keyframes[6].preintegration.covariance.setZero();
  map.keyframes[8].imu_bias.gyroscope.setConstant(std::numeric_limits<float>::quiet_NaN());  // of two links
  const BundleReport report = AdjustBundle(atlas, map.id);
  EXPECT_EQ(report.inertial_links, map.keyframes.size() - 1 - 5);
  EXPECT_THAT(report.warnings, ::testing::ElementsAre(::testing::HasSubstr("5 inertial links are left out")));
}

// Of a map without initialised IMU, velocities turn with their keyframes and biases stay.
TEST(InertialBundle, TurnsVelocitiesThatItDoesNotEstimate) {
  Atlas atlas = MakeTruth({"", Sensor::kStereo, false});
  Map& map = atlas.maps[0];
  for (KeyFrame& keyframe : map.keyframes) keyframe.velocity = {1, 2, 3};
  Shaker().ShakePoses(map, 0.02F, 0.02F);
  const Map before = map;
  AdjustBundle(atlas, map.id);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame &is = map.keyframes[row], &was = before.keyframes[row];
    EXPECT_LT((is.camera_from_world.rotation * is.velocity - was.camera_from_world.rotation * was.velocity).norm(),
              1e-4F);
    EXPECT_EQ(is.imu_bias.gyroscope, was.imu_bias.gyroscope);
  }
}

}  // namespace
}  // namespace slamdb::testing
