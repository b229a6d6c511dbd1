// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/gravity.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

const Similarity3d kTilt{1, Eigen::Quaterniond(0.7, 0.5, -0.4, 0.2).normalized(), {1, 2, 3}};

Map Walk(bool inertial) {
  SyntheticOptions options;
  options.sensor = Sensor::kStereo;
  options.inertial = inertial;
  options.keyframes = 20;
  options.points = 100;
  options.features = 100;
  return SynthesizeAtlas(options).maps[0];
}

double DegreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, a.normalized().dot(b.normalized()))) * 57.29577951308232;
}

TEST(Gravity, InertiaTellsItHoweverTheMapIsTurned) {
  Map map = Walk(true);
  const auto gravity = GravityByInertia(map);
  ASSERT_TRUE(gravity);
  EXPECT_LT(DegreesBetween(*gravity, -Eigen::Vector3d::UnitZ()), 0.5);
  EXPECT_NEAR(gravity->norm(), 9.81, 0.1);
  TransformMap(map, kTilt);
  const Upright upright = FindUp(map, UpMethod::kAuto);
  EXPECT_EQ(upright.method, UpMethod::kInertia);
  EXPECT_LT(DegreesBetween(upright.up, kTilt.rotation * Eigen::Vector3d::UnitZ()), 0.5);
  TransformMap(map, {1, upright.target_from_source});
  EXPECT_LT(DegreesBetween(*UpByInertia(map), Eigen::Vector3d::UnitZ()), 1e-3);
}

TEST(Gravity, NoImuNoGravity) {
  EXPECT_FALSE(GravityByInertia(Walk(false)));
  EXPECT_EQ(KindOf([&] { return FindUp(Walk(false), UpMethod::kInertia); }), ErrorKind::kNotPossible);
  EXPECT_EQ(KindOf([&] { return FindUp(Map{}, UpMethod::kAuto); }), ErrorKind::kNotPossible);
}

// Cameras that look around and somewhat down: their x axes are level.
Map LookAround(int count, double step) {
  Map map;
  for (int i = 0; i < count; ++i) {
    // world: z up; looking along x first, then turning about z, pitched down by 0.3
    const Eigen::Matrix3d level = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
    const Eigen::Quaterniond world_from_camera = Eigen::AngleAxisd(step * i, Eigen::Vector3d::UnitZ()) *
                                                 Eigen::Quaterniond(level) *
                                                 Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitX());
    const Eigen::Vector3d center(3 * std::cos(step * i), 3 * std::sin(step * i), 0);
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(static_cast<std::uint64_t>(i));
    keyframe.camera_from_world.rotation = Quaternionf(world_from_camera.conjugate().cast<float>());
    keyframe.camera_from_world.translation = -(world_from_camera.conjugate() * center).cast<float>();
  }
  return map;
}

TEST(Gravity, CamerasAndPathTellUp) {
  Map map = LookAround(24, 0.25);
  TransformMap(map, kTilt);
  const Eigen::Vector3d up = kTilt.rotation * Eigen::Vector3d::UnitZ();
  const Upright cameras = FindUp(map, UpMethod::kAuto), path = FindUp(map, UpMethod::kPath);
  EXPECT_EQ(cameras.method, UpMethod::kCameras);
  EXPECT_LT(DegreesBetween(cameras.up, up), 0.5);
  EXPECT_LT(cameras.spread, 0.5);
  EXPECT_EQ(path.method, UpMethod::kPath);
  EXPECT_LT(DegreesBetween(path.up, up), 1e-2);
  EXPECT_LT(path.spread, 1e-4);
  EXPECT_LT(DegreesBetween(path.target_from_source * path.up, Eigen::Vector3d::UnitZ()), 1e-6);
}

TEST(Gravity, CamerasThatNeverTurnHaveTheirYAxisDown) {
  const Map map = LookAround(5, 0);
  EXPECT_NEAR(DegreesBetween(FindUp(map, UpMethod::kCameras).up, Eigen::Vector3d::UnitZ()), 0.3 * 57.2958, 0.01);
  EXPECT_EQ(KindOf([&] { return FindUp(map, UpMethod::kPath); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb
