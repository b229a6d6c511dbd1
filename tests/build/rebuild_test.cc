// SPDX-License-Identifier: BSD-3-Clause
// Atlases that are taken apart into columns and built anew: sound, loaded by ORB-SLAM3, and what they were.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <span>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/build/taken_apart.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::Pointwise;

MATCHER_P(IsNearEach, tolerance, "") {
  const auto& [one, other] = arg;
  return std::abs(one - other) <= tolerance * std::max({1.0F, std::abs(one), std::abs(other)});
}

template <class Matrix>
std::span<const float> Numbers(const Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

// Sums of floats and of doubles: relative to the largest number.
template <class Matrix>
void ExpectNear(const Matrix& actual, const Matrix& expected) {
  const float largest = std::max(expected.cwiseAbs().maxCoeff(), 1e-12F);
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff() / largest, 2e-5F) << actual << "\ninstead of\n" << expected;
}

void ExpectSameMotion(const KeyFrame& actual, const KeyFrame& expected) {
  SCOPED_TRACE(ToString(expected.id));
  const ImuPreintegration &one = actual.preintegration, &other = expected.preintegration;
  EXPECT_EQ(actual.previous, expected.previous);
  EXPECT_EQ(actual.next, expected.next);
  EXPECT_EQ(actual.imu_initialized, expected.imu_initialized);
  EXPECT_EQ(actual.velocity, expected.velocity);
  EXPECT_EQ(actual.imu_bias.gyroscope, expected.imu_bias.gyroscope);
  EXPECT_THAT(Numbers(actual.body_position), Pointwise(IsNearEach(1e-5F), Numbers(expected.body_position)));
  EXPECT_EQ(one.measurements.size(), other.measurements.size());
  if (!expected.previous) return;  // of what leads to none ORB-SLAM3 keeps anything
  EXPECT_NEAR(one.duration, other.duration, 1e-4F);
  EXPECT_EQ(one.bias.accelerometer, other.bias.accelerometer);
  EXPECT_EQ(one.updated_bias.gyroscope, other.updated_bias.gyroscope);
  ExpectNear(one.bias_change, other.bias_change);
  ExpectNear(one.rotation, other.rotation);
  ExpectNear(one.velocity, other.velocity);
  ExpectNear(one.position, other.position);
  ExpectNear(one.covariance, other.covariance);
  ExpectNear(one.rotation_by_gyro, other.rotation_by_gyro);
  ExpectNear(one.velocity_by_gyro, other.velocity_by_gyro);
  ExpectNear(one.velocity_by_acc, other.velocity_by_acc);
  ExpectNear(one.position_by_gyro, other.position_by_gyro);
  ExpectNear(one.position_by_acc, other.position_by_acc);
  ExpectNear(one.mean_angular_velocity, other.mean_angular_velocity);
}

void ExpectSameMap(const Map& actual, const Map& expected) {
  ASSERT_EQ(actual.keyframes.size(), expected.keyframes.size());
  EXPECT_EQ(actual.first_keyframe, expected.first_keyframe);
  EXPECT_EQ(actual.lowest_keyframe, expected.lowest_keyframe);
  EXPECT_EQ(actual.inertial, expected.inertial);
  EXPECT_EQ(actual.imu_initialized, expected.imu_initialized);
  EXPECT_EQ(actual.imu_ba2, expected.imu_ba2);
  for (std::size_t row = 0; row < actual.keyframes.size(); ++row) {
    const KeyFrame &one = actual.keyframes[row], &other = expected.keyframes[row];
    EXPECT_EQ(one.features.keypoints, other.features.keypoints);
    EXPECT_EQ(one.features.descriptors, other.features.descriptors);
    EXPECT_EQ(one.features.depth, other.features.depth);
    EXPECT_EQ(one.bounds, other.bounds);
    if (expected.inertial) ExpectSameMotion(one, other);
  }
}

Atlas Decoded(const std::string& file) {
  Notices notices;
  return ReadOrbslam3(Source(std::as_bytes(std::span(file)), "file"), {}, notices);
}

// Of an atlas that is built of columns.
void ExpectLoads(const Atlas& built) {
  EXPECT_EQ(TroublesOf(built, {"point-support"}), "");  // of points that lost what one side said alone
  const std::string file = EncodeOrbslam3(built);
  const Atlas again = Decoded(file);
  EXPECT_THAT(again, EqualsAtlas(built));
  EXPECT_EQ(EncodeOrbslam3(again), file);
}

void ExpectRebuilt(const Atlas& atlas) {
  const Atlas built = BuiltAnew(atlas);
  ExpectLoads(built);
  ASSERT_EQ(built.maps.size(), atlas.maps.size());
  for (std::size_t map = 0; map < atlas.maps.size(); ++map)
    if (!atlas.maps[map].keyframes.empty()) ExpectSameMap(built.maps[map], atlas.maps[map]);
}

class Rebuilt : public ::testing::TestWithParam<SyntheticOptions> {};

TEST_P(Rebuilt, SyntheticAtlas) {
  const Atlas atlas = SynthesizeAtlas(GetParam());
  ExpectRebuilt(atlas);
  const Atlas built = BuiltAnew(atlas);
  std::size_t keyframes = 0;
  for (const Map& map : built.maps) keyframes += map.keyframes.size();
  const TemporaryFolder folder;
  EXPECT_EQ(testing::KeyFramesThatBoostReads(built, folder / "built.osa"), keyframes);
}

INSTANTIATE_TEST_SUITE_P(SensorKinds, Rebuilt, ::testing::ValuesIn(testing::SensorKinds()), [](const auto& kind) {
  std::string name = testing::NameOf(kind.param);
  std::ranges::replace(name, ' ', '_');
  return name;
});

class RebuiltReal : public ::testing::TestWithParam<const char*> {};

TEST_P(RebuiltReal, Atlas) {
  const std::string name = GetParam();
  const char* lab = std::getenv("SLAMDB_LAB2");
  const std::string path = name.size() > 2  ? RealAtlas(name)
                           : lab == nullptr ? ""
                                            : std::string(lab) + "/" + name + ".osa";
  if (path.empty()) GTEST_SKIP() << name << ".osa: set SLAMDB_ATLASES and SLAMDB_LAB2 to the folders that have it";
  Notices notices;
  ExpectRebuilt(ReadOrbslam3(path, {}, notices));
}

INSTANTIATE_TEST_SUITE_P(Files, RebuiltReal,
                         ::testing::Values("session_small_a", "stereo_inertial", "fisheye_stereo", "multimap_rgbd",
                                           "i1", "i2"),
                         [](const auto& file) { return std::string(file.param); });

TEST(Build, EmptyMapsAndKeyFramesWithoutKeypointsLoad) {
  Atlas atlas;
  atlas.vocabulary = {"ORBvoc.txt", std::string(32, '0')};
  const CameraId camera = AddCamera(atlas, CameraModel::kPinhole, {400, 400, 320, 240});
  const MapId empty = AddMap(atlas), map = AddMap(atlas);
  EXPECT_TRUE(AddKeyFrames(atlas, empty, {.camera = camera}).empty());
  EXPECT_TRUE(AddPoints(atlas, empty, {}).empty());
  EXPECT_FALSE(atlas.maps[0].first_keyframe);
  AddKeyFrames(atlas, map,
               {.timestamps = {1, 2},
                .camera_from_world = {{}, {}},
                .features = {{}, {}},
                .camera = camera,
                .width = 640,
                .height = 480});
  for (const KeyFrame& keyframe : atlas.maps[1].keyframes) {
    EXPECT_EQ(keyframe.features.grid.column_sizes.size(), 64U) << "ORB-SLAM3 looks into cells";
    EXPECT_EQ(keyframe.features.grid.cell_sizes.size(), 64U * 48U);
  }
  const std::string file = EncodeOrbslam3(atlas);
  EXPECT_THAT(Decoded(file), EqualsAtlas(atlas));
}

TEST(Build, WhatIsDerivedOfAnotherKeyFrameIsDerivedAnew) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 8, .points = 200, .features = 150});
  const Map& map = atlas.maps[0];
  NewKeyFrames columns = KeyFramesOf(map);
  columns.ids.clear();
  for (std::size_t row = 0; row < columns.features.size(); ++row) {
    Features& features = columns.features[row] = map.keyframes[row].features;  // with its grid, words and points
    features.keypoints.resize(100);
    features.undistorted.clear();
    features.descriptors.resize(100);
    features.right_x.clear();
    features.depth.clear();
  }
  const std::vector<KeyFrameId> ids = AddKeyFrames(atlas, MapId(0), columns);
  for (const KeyFrame& keyframe : std::span(map.keyframes).last(8)) {
    EXPECT_EQ(keyframe.features.grid.keypoints.size(), 100U);
    EXPECT_TRUE(keyframe.features.bag_of_words.words.empty() && keyframe.features.feature_vector.nodes.empty());
    EXPECT_EQ(std::ranges::count(keyframe.features.map_points, MapPointId()), 100);
  }
  EXPECT_EQ(ids.front(), KeyFrameId(8));
}

}  // namespace
}  // namespace slamdb
