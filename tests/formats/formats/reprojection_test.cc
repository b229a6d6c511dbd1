// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

TEST(Reprojection, MeasuresPixels) {
  const Atlas atlas = OneMapAtlas();
  const Map& map = atlas.maps[0];
  const Reprojection reprojection(atlas, map);
  EXPECT_EQ(reprojection.Of(map.points[0], map.points[0].observations[0]).left, 0);
  EXPECT_EQ(reprojection.Of(map.points[0], map.points[0].observations[1]).left, 5);
  EXPECT_TRUE(std::isnan(reprojection.Of(map.points[0], map.points[0].observations[0]).right));
  EXPECT_EQ(reprojection.Mean(map.points[0]), 2.5F);
  EXPECT_TRUE(std::isnan(reprojection.Mean(map.points[2])));
}

TEST(Reprojection, IsNoNumberWhereSomethingIsMissing) {
  Atlas atlas = OneMapAtlas();
  Map& map = atlas.maps[0];
  const auto error = [&](const Observation& observation) {
    return Reprojection(atlas, map).Of(map.points[0], observation).left;
  };
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(99), .left = 0})));
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(), .left = 0})));
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(1), .left = 1})));
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(1), .left = Observation::kAbsent})));
  map.points[0].position.z() = -1;
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(1), .left = 0})));
  map.points[0].position.z() = 2;
  atlas.cameras.clear();
  EXPECT_TRUE(std::isnan(error({.keyframe = KeyFrameId(1), .left = 0})));
}

TEST(Reprojection, FindsTheFirstOfTwoKeyFrames) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes.push_back(atlas.maps[0].keyframes[0]);
  const Reprojection reprojection(atlas, atlas.maps[0]);
  EXPECT_EQ(reprojection.Find(KeyFrameId(3)), &atlas.maps[0].keyframes[0]);
  EXPECT_EQ(reprojection.Find(KeyFrameId(2)), nullptr);
}

class SyntheticReprojection : public ::testing::TestWithParam<Sensor> {};

// Every observation of a sound atlas is the projection of its point with the noise that was asked for, on either side.
TEST_P(SyntheticReprojection, IsTheNoise) {
  const Atlas atlas = SynthesizeAtlas({.sensor = GetParam(), .keyframes = 6, .points = 200, .features = 400});
  const Reprojection reprojection(atlas, atlas.maps[0]);
  int left = 0, right = 0;
  for (const MapPoint& point : atlas.maps[0].points) {
    for (const Observation& observation : point.observations) {
      const Reprojection::Errors errors = reprojection.Of(point, observation);
      left += std::isnan(errors.left) ? 0 : 1;
      right += std::isnan(errors.right) ? 0 : 1;
      EXPECT_EQ(std::isnan(errors.left), observation.left < 0);
      if (!std::isnan(errors.left)) {
        EXPECT_LT(errors.left, 15);
      }
      if (!std::isnan(errors.right)) {
        EXPECT_LT(errors.right, 15);
      }
    }
  }
  EXPECT_GT(left, 100);
  EXPECT_EQ(right > 0, GetParam() == Sensor::kFisheyeStereo);
}

INSTANTIATE_TEST_SUITE_P(Sensors, SyntheticReprojection,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo));

}  // namespace
}  // namespace slamdb
