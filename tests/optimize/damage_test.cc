// SPDX-License-Identifier: BSD-3-Clause
// Atlases that no SLAM system wrote: nothing crashes, hangs, or spreads what is not a number.
#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "slamdb/optimize/optimize.h"
#include "tests/optimize/shaken.h"

namespace slamdb::testing {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

struct Damage {
  const char* name;
  std::function<void(Atlas&)> spoil;
};

const Damage kDamages[] = {
    {"NothingInIt", [](Atlas& atlas) { atlas.maps.clear(); }},
    {"EmptyMap", [](Atlas& atlas) { atlas.maps[0] = Map{.id = atlas.maps[0].id}; }},
    {"NoCameras", [](Atlas& atlas) { atlas.cameras.clear(); }},
    {"CameraOfNaN", [](Atlas& atlas) { atlas.cameras[0].parameters[0] = kNaN; }},
    {"PoseOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[3].camera_from_world.translation.x() = kNaN; }},
    {"RotationOfZeros", [](Atlas& atlas) { atlas.maps[0].keyframes[3].camera_from_world.rotation.coeffs().setZero(); }},
    {"InitialOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[0].camera_from_world.rotation.coeffs()[0] = kNaN; }},
    {"PointAtInfinity", [](Atlas& atlas) { atlas.maps[0].points[3].position.x() = kInfinity; }},
    {"PointFarAway", [](Atlas& atlas) { atlas.maps[0].points[3].position.setConstant(1e30F); }},
    {"PointAtACamera",
     [](Atlas& atlas) { atlas.maps[0].points[3].position = CameraCenter(atlas.maps[0].keyframes[0]); }},
    {"KeypointOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[3].features.undistorted[0].x = kNaN; }},
    {"OctaveBeyondAll", [](Atlas& atlas) { atlas.maps[0].keyframes[3].features.undistorted[0].octave = 1 << 30; }},
    {"SigmasOfNothing", [](Atlas& atlas) { atlas.maps[0].keyframes[3].pyramid.inverse_sigma2.assign(8, kNaN); }},
    {"DanglingObserver", [](Atlas& atlas) { atlas.maps[0].points[3].observations[0].keyframe = KeyFrameId(9999); }},
    {"RowsBeyondAll",
     [](Atlas& atlas) { atlas.maps[0].points[3].observations[0].left = std::numeric_limits<std::int32_t>::max(); }},
    {"ColumnsGone", [](Atlas& atlas) { atlas.maps[0].keyframes[3].features.map_points.clear(); }},
    {"ParentsInACircle",
     [](Atlas& atlas) {
       auto& keyframes = atlas.maps[0].keyframes;
       keyframes[1].parent = keyframes[2].id;
       keyframes[2].parent = keyframes[1].id;
     }},
    {"ItsOwnParent", [](Atlas& atlas) { atlas.maps[0].keyframes[1].parent = atlas.maps[0].keyframes[1].id; }},
    {"EveryKeyframeBad",
     [](Atlas& atlas) {
       for (KeyFrame& k : atlas.maps[0].keyframes) k.bad = true;
     }},
    {"OneKeyframe", [](Atlas& atlas) { atlas.maps[0].keyframes.resize(1); }},
    {"SameIds",
     [](Atlas& atlas) {
       for (KeyFrame& k : atlas.maps[0].keyframes) k.id = KeyFrameId(1);
     }},
    {"VelocityOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[3].velocity.setConstant(kNaN); }},
    {"BiasOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[3].imu_bias.gyroscope.setConstant(kNaN); }},
    {"CalibrationOfNaN",
     [](Atlas& atlas) { atlas.maps[0].keyframes[3].imu_calibration.camera_from_body.translation.setConstant(kNaN); }},
    {"PreintegrationOfNaN", [](Atlas& atlas) { atlas.maps[0].keyframes[3].preintegration.rotation.setConstant(kNaN); }},
    {"CovarianceOfInfinity",
     [](Atlas& atlas) { atlas.maps[0].keyframes[3].preintegration.covariance.setConstant(kInfinity); }},
    {"RightColumnOfNaN",
     [](Atlas& atlas) {
       for (float& x : atlas.maps[0].keyframes[3].features.right_x) x = kNaN;
     }},
    {"BaselineOfInfinity", [](Atlas& atlas) { atlas.maps[0].keyframes[3].intrinsics.baseline_fx = kInfinity; }},
    {"MountOfNaN",
     [](Atlas& atlas) { atlas.maps[0].keyframes[3].left_from_right.rotation.coeffs().setConstant(kNaN); }},
};

class DamagedMap : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedMap, IsOptimisedAsFarAsItGoes) {
  for (const OptimizeWorld& world : kOptimizeWorlds) {
    SCOPED_TRACE(world.name);
    Atlas atlas = SynthesizeAtlas(
        {.sensor = world.sensor, .inertial = world.inertial, .keyframes = 8, .points = 120, .features = 150});
    GetParam().spoil(atlas);
    const Atlas before = atlas;
    OptimizeMaps(atlas);
    if (atlas.maps.empty()) continue;
    const Map &map = atlas.maps[0], &was = before.maps[0];
    for (std::size_t row = 0; row < map.keyframes.size(); ++row)
      EXPECT_TRUE(map.keyframes[row].camera_from_world.translation.allFinite() ||
                  !was.keyframes[row].camera_from_world.translation.allFinite());
    const auto lost = [](const MapPoint& point) { return !point.position.allFinite(); };
    EXPECT_LE(std::ranges::count_if(map.points, lost), std::ranges::count_if(was.points, lost));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedMap, ::testing::ValuesIn(kDamages),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace slamdb::testing
