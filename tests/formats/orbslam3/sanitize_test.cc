// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/sanitize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Atlas Sound(bool inertial = false) {
  return SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = inertial, .keyframes = 12, .points = 500});
}

TEST(SanitizeForOrbslam3, LeavesASoundAtlasAsItIs) {
  for (const bool inertial : {false, true}) {
    Atlas atlas = Sound(inertial);
    const std::string once = EncodeOrbslam3(atlas);
    EXPECT_THAT(detail::SanitizeForOrbslam3(atlas), IsEmpty());
    EXPECT_TRUE(EncodeOrbslam3(atlas) == once);
  }
}

TEST(SanitizeForOrbslam3, DropsRepeatedAndEmptyMaps) {
  Atlas atlas = Sound();
  detail::SanitizeForOrbslam3(atlas);
  atlas.maps.emplace_back().id = MapId(9);
  atlas.repeated_maps.push_back({.position = 2, .owner_map = 0, .row = 0});
  EXPECT_THAT(detail::SanitizeForOrbslam3(atlas),
              ElementsAre(HasSubstr("1 map pointer stored twice"), HasSubstr("1 empty map dropped")));
  EXPECT_EQ(atlas.maps.size(), 1U);
  EXPECT_THAT(atlas.repeated_maps, IsEmpty());
}

TEST(SanitizeForOrbslam3, ZeroesUninitialisedMembersButKeepsAMergeScale) {
  Atlas atlas = Sound();
  detail::SanitizeForOrbslam3(atlas);
  KeyFrame& garbage = atlas.maps[0].keyframes[0];
  garbage.merge_scale = std::numeric_limits<float>::quiet_NaN();
  garbage.preintegration.covariance(3, 4) = 1e30F;
  garbage.body_position.x() = std::numeric_limits<float>::infinity();
  garbage.imu_calibration.noise[2] = -5;
  atlas.maps[0].keyframes[1].merge_scale = 1.02F;
  EXPECT_THAT(detail::SanitizeForOrbslam3(atlas),
              ElementsAre(HasSubstr("1 uninitialised merge scale ("), HasSubstr("1 uninitialised preintegration ("),
                          HasSubstr("1 uninitialised body position ("), HasSubstr("1 uninitialised IMU noise (")));
  EXPECT_EQ(garbage.merge_scale, 0);
  EXPECT_EQ(garbage.preintegration.covariance, Matrix15f::Zero());
  EXPECT_EQ(garbage.body_position, Eigen::Vector3f::Zero());
  EXPECT_EQ(atlas.maps[0].keyframes[1].merge_scale, 1.02F);
}

TEST(SanitizeForOrbslam3, KeepsInertialData) {
  Atlas atlas = Sound(/*inertial=*/true);
  const ImuPreintegration& imu = atlas.maps[0].keyframes[3].preintegration;
  const Matrix15f covariance = imu.covariance;
  const Eigen::Vector3f body = atlas.maps[0].keyframes[3].body_position;
  ASSERT_GT(imu.duration, 0);
  detail::SanitizeForOrbslam3(atlas);
  EXPECT_EQ(imu.covariance, covariance);
  EXPECT_EQ(atlas.maps[0].keyframes[3].body_position, body);
}

TEST(SanitizeForOrbslam3, PointsADanglingReferenceAtAnObserver) {
  Atlas atlas = Sound();
  detail::SanitizeForOrbslam3(atlas);
  MapPoint& point = atlas.maps[0].points[7];
  point.reference = KeyFrameId(123456);
  EXPECT_THAT(detail::SanitizeForOrbslam3(atlas), ElementsAre(HasSubstr("1 reference keyframe outside the map")));
  EXPECT_EQ(point.reference, point.observations[0].keyframe);
}

TEST(SanitizeForOrbslam3, MakesFlagsZeroOrOne) {
  Atlas atlas = Sound();
  detail::SanitizeForOrbslam3(atlas);
  atlas.maps[0].keyframes[2].not_erase.recorded = 0xCD;
  EXPECT_THAT(detail::SanitizeForOrbslam3(atlas), ElementsAre(HasSubstr("1 flag neither")));
  EXPECT_EQ(atlas.maps[0].keyframes[2].not_erase.recorded, 1);
}

// What is said of an atlas that is written as text.
std::vector<Notice> NoticesOfText(Atlas atlas, bool sanitize) {
  atlas.encoding.text = true;
  WriteOptions options;
  options.of<Orbslam3WriteOptions>().sanitize = sanitize;
  Notices notices;
  WriteOrbslam3(atlas, Target([](Bytes) {}, "atlas.osa"), options, notices);
  return notices.items();
}

// Boost does not read them back. Names are not numbers.
TEST(WriteOrbslam3, WarnsOfTextWithNanAndInfinity) {
  Atlas atlas = Sound();
  detail::SanitizeForOrbslam3(atlas);
  atlas.vocabulary.name = "info nan inf.txt";
  EXPECT_THAT(NoticesOfText(atlas, /*sanitize=*/false), IsEmpty());
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    atlas.maps[0].keyframes.back().merge_scale = value;
    EXPECT_THAT(NoticesOfText(atlas, /*sanitize=*/false),
                ElementsAre(testing::Field(&Notice::text, HasSubstr("the text holds nan or inf"))));
    EXPECT_THAT(NoticesOfText(atlas, /*sanitize=*/true),
                ElementsAre(testing::Field(&Notice::text, HasSubstr("uninitialised merge scale"))));
  }
}

}  // namespace
}  // namespace slamdb
