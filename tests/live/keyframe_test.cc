// SPDX-License-Identifier: BSD-3-Clause
// KeyFrame: pose, features, point slots.
#include "slamdb/live/keyframe.h"

#include "slamdb/base/error.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

const Quaternionf kQuarterTurn(Eigen::AngleAxisf(static_cast<float>(M_PI) / 2, Eigen::Vector3f::UnitZ()));

TEST(KeyFrame, OfAFrame) {
  World world;
  Frame frame = world.MakeFrame({1, 2, 3});
  frame.mTimeStamp = 12.5;
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  frame.mvpMapPoints[4] = point;
  world.map()->SetImuInitialized();
  KeyFrame keyframe(frame, world.map());
  EXPECT_EQ(keyframe.mnId, 1U);
  EXPECT_EQ(keyframe.mnFrameId, frame.mnId);
  EXPECT_EQ(keyframe.mTimeStamp, 12.5);
  EXPECT_EQ(keyframe.N, World::kFeatures);
  EXPECT_EQ(keyframe.NLeft, -1);
  EXPECT_EQ(keyframe.mpCamera, world.left);
  EXPECT_TRUE(keyframe.bImu);
  EXPECT_EQ(keyframe.mnOriginMapId, world.map()->GetId());
  EXPECT_EQ(keyframe.GetMapPoint(4), point);
  EXPECT_EQ(keyframe.GetNumberMPs(), 1);
  EXPECT_EQ(keyframe.GetCameraCenter(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(keyframe.GetParent(), nullptr);
  EXPECT_EQ(world.map()->KeyFramesInMap(), 1U) << "adding it is the caller's";
}

TEST(KeyFrame, ConvertsItsPose) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  keyframe->SetPose({kQuarterTurn, {1, 0, 0}});  // x_camera = turn * x_world + (1, 0, 0)
  EXPECT_LT((keyframe->GetCameraCenter() - Eigen::Vector3f(0, 1, 0)).norm(), 1e-6F);
  EXPECT_LT((keyframe->GetPoseInverse().translation - keyframe->GetCameraCenter()).norm(), 1e-6F);
  EXPECT_LT((keyframe->GetRotation() * Eigen::Vector3f::UnitX() - Eigen::Vector3f::UnitY()).norm(), 1e-6F);
  EXPECT_EQ(keyframe->GetTranslation(), Eigen::Vector3f(1, 0, 0));
  // The right camera is 0.5 to the right: camera x is world -y.
  EXPECT_LT((keyframe->GetRightCameraCenter() - Eigen::Vector3f(0, 0.5F, 0)).norm(), 1e-6F);
  EXPECT_LT((keyframe->GetRightPose() * keyframe->GetRightCameraCenter()).norm(), 1e-6F);
  keyframe->SetPose({Quaternionf(2, 0, 0, 0), {0, 0, 0}});
  EXPECT_FLOAT_EQ(keyframe->GetPose().rotation.norm(), 1);
}

TEST(KeyFrame, KnowsTheBody) {
  World world;
  slamdb::KeyFrame image = world.Image();
  image.imu_calibration.is_set = true;
  image.imu_calibration.camera_from_body.translation = {0, 0, 1};
  Frame frame(world.atlas, image, world.left);
  KeyFrame keyframe(frame, world.map());
  keyframe.SetPose({Quaternionf::Identity(), {-2, 0, 0}});
  EXPECT_EQ(keyframe.GetImuPosition(), Eigen::Vector3f(2, 0, 1));
  EXPECT_FALSE(keyframe.isVelocitySet());
  keyframe.SetVelocity({1, 0, 0});
  EXPECT_TRUE(keyframe.isVelocitySet());
  EXPECT_EQ(keyframe.GetVelocity(), Eigen::Vector3f(1, 0, 0));
  ImuBias bias;
  bias.gyroscope = {1, 2, 3};
  keyframe.SetNewBias(bias);
  EXPECT_EQ(keyframe.GetImuBias().gyroscope, bias.gyroscope);
  EXPECT_EQ(keyframe.GetImuPreintegrated().bias_change.head<3>(), bias.gyroscope);
}

TEST(KeyFrame, HoldsPointsInSlots) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint *a = world.AddPoint(keyframe), *b = world.AddPoint(keyframe), *bad = world.AddPoint(keyframe);
  bad->SetBadFlag();
  World::Observe(a, keyframe, 2);
  keyframe->AddMapPoint(b, 3);
  keyframe->AddMapPoint(bad, 5);
  EXPECT_THAT(keyframe->GetMapPoints(), UnorderedElementsAre(a, b));
  EXPECT_EQ(keyframe->GetMapPointMatches()[5], bad);
  EXPECT_EQ(keyframe->GetMapPointMatches().size(), static_cast<std::size_t>(World::kFeatures));
  EXPECT_EQ(keyframe->GetNumberMPs(), 3);
  EXPECT_EQ(keyframe->TrackedMapPoints(0), 2);
  EXPECT_EQ(keyframe->TrackedMapPoints(1), 1);
  keyframe->ReplaceMapPointMatch(3, a);
  EXPECT_EQ(keyframe->GetMapPoint(3), a);
  keyframe->EraseMapPointMatch(3);
  EXPECT_EQ(keyframe->GetMapPoint(3), nullptr);
  keyframe->EraseMapPointMatch(a);  // where the point says it is
  EXPECT_EQ(keyframe->GetMapPoint(2), nullptr);
  EXPECT_THROW(keyframe->AddMapPoint(a, 1000), Error);
}

TEST(KeyFrame, UnprojectsWhatHasDepth) {
  World world(Eyes::kStereo);
  KeyFrame* keyframe = world.AddKeyFrame({0, 0, 10});
  Eigen::Vector3f position;
  ASSERT_TRUE(keyframe->UnprojectStereo(4, position));  // pixel (40, 20), depth 2
  EXPECT_LT((position - Eigen::Vector3f(-5.6F, -4.4F, 12)).norm(), 1e-5F);
  EXPECT_FALSE(keyframe->UnprojectStereo(5, position));
}

TEST(KeyFrame, FindsFeaturesInAnArea) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  EXPECT_THAT(keyframe->GetFeaturesInArea(100, 20, 15), ElementsAre(9, 10, 11));
  EXPECT_THAT(keyframe->GetFeaturesInArea(100, 20, 10), ElementsAre(10)) << "less than the radius";
  EXPECT_THAT(keyframe->GetFeaturesInArea(-5, 20, 6), ElementsAre(0));
  EXPECT_TRUE(keyframe->GetFeaturesInArea(100, 200, 15).empty());
  EXPECT_TRUE(keyframe->GetFeaturesInArea(-1000, -1000, 15).empty());
  EXPECT_TRUE(keyframe->IsInImage(0, 0));
  EXPECT_FALSE(keyframe->IsInImage(640, 0));
  EXPECT_FALSE(keyframe->IsInImage(0, -1));
}

TEST(KeyFrame, FindsRightFeatures) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  EXPECT_THAT(keyframe->GetFeaturesInArea(210, 20, 5, true), ElementsAre(1)) << "a row of the right keypoints";
}

TEST(KeyFrame, ComputesTheMedianDepth) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame({0, 0, 1});
  EXPECT_EQ(keyframe->ComputeSceneMedianDepth(2), -1);
  const float depths[] = {5, 2, 9, 3};
  for (std::size_t i = 0; i < 4; ++i) keyframe->AddMapPoint(world.AddPoint(keyframe, {0, 0, depths[i] + 1}), i);
  EXPECT_EQ(keyframe->ComputeSceneMedianDepth(2), 3);  // sorted 2 3 5 9, element (4 - 1) / 2
  EXPECT_EQ(keyframe->ComputeSceneMedianDepth(1), 9);
}

}  // namespace
}  // namespace slamdb::live
