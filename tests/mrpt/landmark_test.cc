// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/mrpt/landmark.h"

#include <gmock/gmock.h>

#include <limits>
#include <type_traits>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using mrpt::CLandmark;
using mrpt::CLandmarksMap;
using ::testing::SizeIs;

Atlas AtlasOf(std::vector<Landmark> landmarks) {
  Atlas atlas;
  atlas.maps.resize(1);
  atlas.maps[0].landmarks = std::move(landmarks);
  return atlas;
}

// A stereo landmark with a value of its own in every field, and numbers that only wide types hold.
Landmark Full() {
  Landmark landmark;
  landmark.id = LandmarkId((std::uint64_t{1} << 62) + 1);
  landmark.mean = {0.1, -2e9, 3};
  landmark.normal = {0, 0.6, 0.8};
  landmark.cov_11 = 0.1;
  landmark.cov_22 = 0.2;
  landmark.cov_33 = 0.3;
  landmark.cov_12 = 1e-300;
  landmark.cov_13 = -0.05;
  landmark.cov_23 = 0.01;
  landmark.last_seen = 133'444'736'002'500'000;
  landmark.seen_count = 5;
  for (int i = 0; i < 2; ++i) {
    LandmarkFeature& feature = landmark.features.emplace_back();
    feature.x = 100.5F + static_cast<float>(i);
    feature.y = 50.25F;
    feature.keypoint_id = 1000 + static_cast<std::uint64_t>(i);
    feature.type = i == 0 ? FeatureType::kOrb : static_cast<FeatureType>(777);
    feature.track_status = 70'000;
    feature.response = 30;
    feature.orientation = 1.5F;
    feature.octave = 3;
    feature.user_flags = 9;
    feature.depth = 4;
    feature.initial_depth = 4.25;
    feature.position_in_camera = {0.1, 0.2, 4};
    feature.patch_size = 31;
    feature.has_patch = i == 1;
    if (feature.has_patch) feature.patch = {1, 2, 3};
    feature.spin_image_rows = 7;
    feature.polar_images_without_rotation = i == 0;
    for (const DescriptorKind kind :
         {DescriptorKind::kSift, DescriptorKind::kSurf, DescriptorKind::kSpinImage, DescriptorKind::kPolarImage,
          DescriptorKind::kLogPolarImage, DescriptorKind::kOrb, DescriptorKind::kBld, DescriptorKind::kLatch})
      if (i == 0 || kind == DescriptorKind::kOrb)
        feature.descriptors.push_back({kind, std::vector<std::uint8_t>(8, static_cast<std::uint8_t>(kind))});
  }
  return landmark;
}

TEST(CLandmark, KeepsEveryFieldBothWays) {
  const Landmark landmark = Full();
  const CLandmark converted(landmark);
  EXPECT_THAT(AtlasOf({converted.ToLandmark()}), EqualsAtlas(AtlasOf({landmark})));
  EXPECT_EQ(CLandmark(converted.ToLandmark()), converted);
  EXPECT_THAT(AtlasOf({CLandmark().ToLandmark()}), EqualsAtlas(AtlasOf({Landmark()}))) << "defaults are the same";
}

TEST(CLandmark, HasTheNamesOfMrpt) {
  const CLandmark landmark(Full());
  static_assert(std::is_same_v<CLandmark::TLandmarkID, std::int64_t>);
  EXPECT_EQ(landmark.ID, (CLandmark::TLandmarkID{1} << 62) + 1);
  EXPECT_EQ(landmark.pose_mean.y, -2e9);
  EXPECT_EQ(landmark.normal.z, 0.8);
  EXPECT_EQ(landmark.pose_cov_11, 0.1);
  EXPECT_EQ(landmark.pose_cov_23, 0.01);
  EXPECT_EQ(mrpt::Clock::toDouble(landmark.timestampLastSeen), 1700000000.25);
  EXPECT_EQ(mrpt::Clock::fromDouble(1700000000.25), landmark.timestampLastSeen);
  EXPECT_EQ(landmark.seenTimesCount, 5U);
  ASSERT_THAT(landmark.features, SizeIs(2)) << "two for stereo";
  EXPECT_EQ(landmark.getType(), mrpt::featORB);
  const mrpt::CFeature& left = landmark.features[0];
  EXPECT_EQ(left.keypoint.pt.x, 100.5F);
  EXPECT_EQ(left.keypoint.ID, 1000U);
  EXPECT_EQ(left.keypoint.octave, 3);
  EXPECT_EQ(left.keypoint.response, 30);
  EXPECT_EQ(left.patchSize, 31);
  EXPECT_FALSE(left.patch.has_value());
  EXPECT_EQ(left.initialDepth, 4.25);
  EXPECT_EQ(left.p3D.x, 0.1);
  ASSERT_TRUE(left.descriptors.hasDescriptorORB());
  EXPECT_EQ(left.descriptors.ORB->size(), 8U);
  EXPECT_THAT(*left.descriptors.SURF, SizeIs(2)) << "floats";
  const mrpt::CFeature& right = landmark.features[1];
  EXPECT_EQ(right.get_type(), 777);
  EXPECT_FALSE(right.descriptors.hasDescriptorSIFT());
  EXPECT_EQ(CLandmark().ID, mrpt::INVALID_LANDMARK_ID);
  EXPECT_EQ(CLandmark().timestampLastSeen, mrpt::INVALID_TIMESTAMP);
}

TEST(CLandmark, GivesAndTakesItsPose) {
  const CLandmark landmark(Full());
  mrpt::CPointPDFGaussian pose;
  landmark.getPose(pose);
  EXPECT_EQ(pose.mean, landmark.pose_mean);
  EXPECT_EQ(pose.cov, Full().pose().covariance);
  mrpt::TPoint3D mean;
  Eigen::MatrixXd covariance;
  landmark.getPose(mean, covariance);
  EXPECT_EQ(mean, pose.mean);
  EXPECT_EQ(covariance, pose.cov);
  pose.mean.x = 7;
  pose.cov(0, 1) = 0.5;
  pose.cov(1, 0) = 99;  // the lower triangle does not count
  CLandmark moved = landmark;
  moved.setPose(pose);
  EXPECT_EQ(moved.pose_mean.x, 7);
  EXPECT_EQ(moved.pose_cov_12, 0.5);
  EXPECT_EQ(moved.pose_cov_33, landmark.pose_cov_33);
  pose.cov << 11, 12, 13, 0, 22, 23, 0, 0, 33;
  moved.setPose(pose);
  EXPECT_EQ(moved.pose_cov_11, 11);
  EXPECT_EQ(moved.pose_cov_22, 22);
  EXPECT_EQ(moved.pose_cov_33, 33);
  EXPECT_EQ(moved.pose_cov_12, 12);
  EXPECT_EQ(moved.pose_cov_13, 13);
  EXPECT_EQ(moved.pose_cov_23, 23);
}

TEST(CLandmark, CanHaveOneFeatureMadeOrKept) {
  CLandmark none, two(Full());
  EXPECT_THROW(none.getType(), Error);
  none.createOneFeature();
  EXPECT_EQ(none.getType(), mrpt::featNotDefined);
  two.createOneFeature();
  ASSERT_THAT(two.features, SizeIs(1));
  EXPECT_EQ(two.features[0].keypoint.ID, 1000U);
}

TEST(CLandmark, RefusesHalfAFloat) {
  Landmark landmark = Full();
  landmark.features[0].descriptors[1].bytes.pop_back();  // SURF
  try {
    const CLandmark converted(landmark);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  }
}

TEST(CLandmarksMap, HoldsWhatMrptWrote) {
  Notices notices;
  const Atlas atlas = ReadAtlas(SLAMDB_FIXTURES "/mrpt/landmarks.bin");
  const std::vector<Landmark>& landmarks = atlas.maps.at(0).landmarks;
  CLandmarksMap map(landmarks);
  ASSERT_EQ(map.size(), 2U);
  EXPECT_THAT(AtlasOf(map.ToLandmarks()), EqualsAtlas(AtlasOf(landmarks)));
  ASSERT_NE(map.landmarks.getByID(7), nullptr);
  EXPECT_EQ(map.landmarks.getByID(7)->seenTimesCount, 5U);
  EXPECT_EQ(map.landmarks.getByID(8888), nullptr);
  EXPECT_EQ(map.landmarks.get(0)->ID, 7);
  EXPECT_EQ(map.landmarks.get(2), nullptr);
  map.landmarks.push_back(CLandmark());
  EXPECT_NE(map.landmarks.getByID(mrpt::INVALID_LANDMARK_ID), nullptr);
  map.landmarks.erase(0);
  map.landmarks.erase(77);
  EXPECT_EQ(map.landmarks.getByID(7), nullptr);
  EXPECT_EQ(map.size(), 2U);
}

}  // namespace
}  // namespace slamdb
