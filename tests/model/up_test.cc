// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/up.h"

#include <gmock/gmock.h>

#include <numbers>
#include <random>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

const Similarity3d kTilt{1, Eigen::Quaterniond(0.7, 0.5, -0.4, 0.2).normalized(), {1, 2, 3}};

double DegreesBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// The same map in the frame of its first camera, as ORB-SLAM3 has those without IMU.
Map AsFirstCamera(Map map) {
  const Rigid3f pose = map.keyframes.front().camera_from_world.Normalized();
  TransformMap(map, {1, Eigen::Quaterniond(pose.rotation.cast<double>()), pose.translation.cast<double>()});
  return map;
}

// How a camera is held; degrees. Heading from x to the left, pitch downwards.
struct Hold {
  double heading = 0, pitch = 0, roll = 0;
  Vector3d center = Vector3d::Zero();
};

// A world with z up.
Map HeldAs(const std::vector<Hold>& holds) {
  Map map;
  map.id = MapId(0);
  const Eigen::Matrix3d ahead = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();  // looks along x, level
  for (const Hold& hold : holds) {
    const Eigen::Quaterniond world_from_camera = Eigen::AngleAxisd(hold.heading * kDegree, Vector3d::UnitZ()) *
                                                 Eigen::Quaterniond(ahead) *
                                                 Eigen::AngleAxisd(-hold.pitch * kDegree, Vector3d::UnitX()) *
                                                 Eigen::AngleAxisd(hold.roll * kDegree, Vector3d::UnitZ());
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(map.keyframes.size() - 1);
    keyframe.camera_from_world.rotation = Quaternionf(world_from_camera.conjugate().cast<float>());
    keyframe.camera_from_world.translation = -(world_from_camera.conjugate() * hold.center).cast<float>();
  }
  return map;
}

// One that goes round a circle of three metres and looks ahead.
std::vector<Hold> Round(int count, double pitch) {
  std::vector<Hold> holds;
  for (int i = 0; i < count; ++i) {
    const double angle = 360.0 * i / count;
    holds.push_back({.heading = angle + 90,
                     .pitch = pitch,
                     .center = {3 * std::cos(angle * kDegree), 3 * std::sin(angle * kDegree), 0}});
  }
  return holds;
}

Map Inertial() {
  SyntheticOptions options{
      .sensor = Sensor::kStereo, .inertial = true, .keyframes = 20, .points = 100, .features = 100};
  return SynthesizeAtlas(options).maps[0];
}

TEST(Up, InertiaTellsItHoweverTheMapIsTurned) {
  Map map = Inertial();
  const auto gravity = GravityByInertia(map);
  ASSERT_TRUE(gravity);
  EXPECT_LT(DegreesBetween(*gravity, -Vector3d::UnitZ()), 0.5);
  EXPECT_NEAR(gravity->norm(), 9.81, 0.1);
  EXPECT_EQ(FrameText(UpOf(map)), "z up (by inertia)");
  TransformMap(map, kTilt);
  const Up up = UpOf(map);
  EXPECT_EQ(up.method, UpMethod::kInertia);
  EXPECT_NEAR(up.gravity, gravity->norm(), 1e-3);
  EXPECT_LT(up.spread, 10);
  EXPECT_LT(DegreesBetween(up.direction, kTilt.rotation * Vector3d::UnitZ()), 0.5);
  TransformMap(map, {1, UprightFromMap(up.direction)});
  EXPECT_LT(DegreesBetween(UpOf(map).direction, Vector3d::UnitZ()), 1e-3);
}

TEST(Up, NoImuNoGravity) {
  const Map map = HeldAs(Round(24, 0));
  EXPECT_FALSE(GravityByInertia(map));
  EXPECT_EQ(KindOf([&] { return FindUp(map, UpMethod::kInertia); }), ErrorKind::kNotPossible);
  EXPECT_EQ(KindOf([&] { return FindUp(map, UpMethod::kConvention); }), ErrorKind::kUsage);
}

// Walking with a camera that was pitched down when it began: y of the map is not down.
TEST(Up, CamerasTellItWhereTheFirstWasTilted) {
  const Map map = AsFirstCamera(HeldAs(Round(24, 25)));
  const Up up = UpOf(map);
  EXPECT_EQ(up.method, UpMethod::kCameras);
  EXPECT_LT(up.spread, 0.1);
  EXPECT_LT(DegreesBetween(up.direction, {0, -std::cos(25 * kDegree), -std::sin(25 * kDegree)}), 0.1);
  EXPECT_EQ(FrameText(up), "up along 0 -0.91 -0.42 (by cameras)");
  EXPECT_EQ(FrameText(UpOf(AsFirstCamera(HeldAs(Round(24, 4))))), "y down (by cameras)");
}

TEST(Up, AMapThatWasLevelledHasItsOwnFrame) {
  std::vector<Hold> holds = Round(24, 10);
  for (std::size_t i = 0; i < holds.size(); ++i) holds[i].roll = i % 2 == 0 ? 3 : -2;
  Map map = AsFirstCamera(HeldAs(holds));
  TransformMap(map, {1, UprightFromMap(FindUp(map).direction)});
  EXPECT_EQ(FrameText(UpOf(map)), "z up (by frame)");
  EXPECT_EQ(UpOf(map).direction, Vector3d::UnitZ());
  EXPECT_EQ(FindUp(map).method, UpMethod::kCameras) << "who levels asks what tells it";
}

// With a heading that hardly changes x axes alone say as little of what is up as of what is ahead.
TEST(Up, AHandThatRollsIsNoCameraThatTurns) {
  std::mt19937 random(3);
  std::normal_distribution<double> heading(0, 3), roll(0, 10), pitch(10, 5);
  for (const double spread : {1.0, 10.0}) {
    std::vector<Hold> holds;
    for (int i = 0; i < 200; ++i) holds.push_back({spread * heading(random), pitch(random), roll(random)});
    const Up up = UpOf(HeldAs(holds));
    EXPECT_LT(DegreesBetween(up.direction, Vector3d::UnitZ()), 15) << spread;
    EXPECT_NEAR(up.spread, 10, 2) << spread;
  }
}

TEST(Up, ACameraThatNeverTurnsHasItsYAxisDown) {
  const Map map = HeldAs({{.pitch = 17}, {.pitch = 17, .center = {1, 0, 0}}, {.pitch = 17, .center = {2, 0, 0}}});
  EXPECT_NEAR(DegreesBetween(FindUp(map, UpMethod::kCameras).direction, Vector3d::UnitZ()), 17, 0.01);
  EXPECT_EQ(KindOf([&] { return FindUp(map, UpMethod::kPath); }), ErrorKind::kNotPossible);
}

TEST(Up, ACameraThatLooksStraightDownTellsItByTurning) {
  Map map = HeldAs(Round(24, 90));
  TransformMap(map, kTilt);
  const Up up = UpOf(map);
  EXPECT_EQ(up.method, UpMethod::kCameras);
  EXPECT_LT(DegreesBetween(up.direction, kTilt.rotation * Vector3d::UnitZ()), 0.1);
}

// Rolled by a quarter it looks ahead all the same, and its path is level; which side of that is up nobody says.
TEST(Up, ThePathTellsItWhereCamerasDoNot) {
  std::vector<Hold> holds = Round(24, 0);
  for (Hold& hold : holds) hold.roll = 90;
  const Up up = UpOf(HeldAs(holds));
  EXPECT_EQ(up.method, UpMethod::kPath);
  EXPECT_NEAR(std::abs(up.direction.z()), 1, 1e-6);
  for (std::size_t i = 0; i < holds.size(); ++i) holds[i].center.z() = i % 2 == 0 ? 3 : -3;
  EXPECT_EQ(UpOf(HeldAs(holds)).method, UpMethod::kConvention) << "no plane either";
  EXPECT_EQ(KindOf([&] { return FindUp(HeldAs(holds)); }), ErrorKind::kNotPossible);
}

TEST(Up, FindsItByWhatIsAskedFor) {
  Map map = HeldAs(Round(24, 17));
  TransformMap(map, kTilt);
  const Vector3d truth = kTilt.rotation * Vector3d::UnitZ();
  const Up cameras = FindUp(map, UpMethod::kCameras), path = FindUp(map, UpMethod::kPath);
  EXPECT_LT(DegreesBetween(cameras.direction, truth), 0.1);
  EXPECT_EQ(path.method, UpMethod::kPath);
  EXPECT_LT(DegreesBetween(path.direction, truth), 1e-2);
  EXPECT_LT(path.off_path, 1e-4);
}

TEST(Up, OneKeyFrameHasItsCameraLevelAndNoneTheConvention) {
  Map one = HeldAs({{}});
  TransformMap(one, {1, Eigen::Quaterniond(Eigen::AngleAxisd(1, Vector3d::UnitX()))});
  EXPECT_EQ(UpOf(one).method, UpMethod::kCameras);
  EXPECT_LT(DegreesBetween(UpOf(one).direction, {0, -std::sin(1), std::cos(1)}), 0.01);

  Map none;
  EXPECT_EQ(FrameText(UpOf(none)), "y down (by convention)");
  none.imu_initialized = true;
  EXPECT_EQ(FrameText(UpOf(none)), "z up (by convention)");
  EXPECT_EQ(KindOf([&] { return FindUp(none); }), ErrorKind::kNotPossible);
}

TEST(Up, TrustsNoKeyFrameThatIsBadOrNotFinite) {
  Map map = HeldAs(Round(24, 0));
  for (const float number : {NAN, INFINITY, 0.0F}) {
    KeyFrame& broken = map.keyframes.emplace_back();
    broken.camera_from_world.rotation = Quaternionf(number, number, number, number);
  }
  KeyFrame& bad = map.keyframes.emplace_back();
  bad.bad = true;
  EXPECT_EQ(UpOf(map).method, UpMethod::kFrame);
  for (KeyFrame& keyframe : map.keyframes) keyframe.bad = true;
  EXPECT_EQ(UpOf(map).method, UpMethod::kConvention);
}

TEST(Up, MapsThatDifferByTheirErrorShareThatOfTheSurer) {
  Map first = AsFirstCamera(HeldAs(Round(24, 4))), second = AsFirstCamera(HeldAs(Round(12, 8)));
  Map other = AsFirstCamera(HeldAs(Round(12, 40))), none;
  const std::vector<const Map*> maps = {&second, &first, &other, &none};
  const std::vector<Up> ups = UpsOf(maps);
  EXPECT_EQ(ups[0].direction, UpOf(first).direction) << "it has more keyframes";
  EXPECT_EQ(ups[1].direction, UpOf(first).direction);
  EXPECT_EQ(ups[2].direction, UpOf(other).direction);
  EXPECT_EQ(ups[3].direction, UpOf(first).direction) << "it tells nothing";
  for (const Up& up : UpsOf(maps, true)) EXPECT_EQ(up.direction, UpOf(first).direction);

  Map inertial = Inertial();
  TransformMap(inertial, {1, Eigen::Quaterniond(Eigen::AngleAxisd(100 * kDegree, Vector3d::UnitX()))});
  EXPECT_EQ(UpsOf({&first, &inertial})[0].method, UpMethod::kInertia) << "ten degrees off";
}

TEST(Up, UprightHasTheAxesOfTheMapWhereItCan) {
  const auto axes = [](const Vector3d& up) { return UprightFromMap(up).toRotationMatrix(); };
  EXPECT_TRUE(axes({0, 0, 1}).isIdentity(1e-12));
  EXPECT_TRUE(axes({0, -1, 0}).row(0).isApprox(Eigen::RowVector3d(1, 0, 0)));
  EXPECT_TRUE(axes({0, -1, 0}).row(1).isApprox(Eigen::RowVector3d(0, 0, 1)));
  for (const Vector3d& nearly : {Vector3d(0.01, 0, -1), Vector3d(0, -0.01, -1), Vector3d(0, 0, -1)}) {
    EXPECT_GT(axes(nearly)(0, 0), 0.99) << "half a turn about x, not about what is left of chance";
    EXPECT_TRUE((axes(nearly) * nearly.normalized()).isApprox(Vector3d::UnitZ(), 1e-9));
  }
}

TEST(Up, NamesAxesOnlyWhereTheyAre) {
  EXPECT_EQ(NearAxis({0.1, 0, 2}), "z");
  EXPECT_EQ(NearAxis({0, -1, 0.1}), "-y");
  EXPECT_FALSE(NearAxis({0, -1, 0.3}));
  EXPECT_EQ(FrameText({.direction = {-1, 0, 0}, .method = UpMethod::kPath}), "x down (by path)");
}

}  // namespace
}  // namespace slamdb
