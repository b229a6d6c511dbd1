// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/map_point.h"

#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::FloatNear;

int FirstByte(const cv::Mat& descriptor) { return descriptor.at<std::uint8_t>(0, 0); }

TEST(MapPoint, OfAReferenceKeyFrame) {
  World world;
  world.atlas.runtime().frame_ids.Set(50, 0);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint point({1, 2, 3}, keyframe, world.map());
  MapPoint next({1, 2, 3}, keyframe, world.map());
  EXPECT_EQ(point.GetWorldPos(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(point.GetNormal(), Eigen::Vector3f::Zero());
  EXPECT_EQ(point.GetReferenceKeyFrame(), keyframe);
  EXPECT_EQ(point.GetMap(), world.map());
  EXPECT_EQ(point.mnFirstKFid, static_cast<long>(keyframe->mnId));
  EXPECT_EQ(point.mnFirstFrame, 50);
  EXPECT_EQ(point.mnOriginMapId, world.map()->GetId());
  EXPECT_EQ(next.mnId, point.mnId + 1);
  EXPECT_EQ(point.Observations(), 0);
  EXPECT_TRUE(point.GetObservations().empty()) << "no constructor adds an observation";
  EXPECT_FALSE(point.isBad());
  EXPECT_EQ(point.GetReplaced(), nullptr);
  EXPECT_EQ(point.GetFound(), 1);
  EXPECT_EQ(point.GetFoundRatio(), 1);
  EXPECT_TRUE(point.GetDescriptor().empty());
  EXPECT_EQ(point.GetMinDistanceInvariance(), 0);
  EXPECT_EQ(point.GetMaxDistanceInvariance(), 0);
}

TEST(MapPoint, OfInverseDepth) {
  World world;
  KeyFrame *reference = world.AddKeyFrame(), *host = world.AddKeyFrame();
  MapPoint point(0.25, cv::Point2f(100.5F, 200.25F), reference, host, world.map());
  EXPECT_EQ(point.mInvDepth, 0.25);
  EXPECT_EQ(point.mInitU, 100.5);
  EXPECT_EQ(point.mInitV, 200.25);
  EXPECT_EQ(point.mpHostKF, host);
  EXPECT_EQ(point.GetReferenceKeyFrame(), reference);
  EXPECT_EQ(point.mnFirstKFid, static_cast<long>(reference->mnId));
}

TEST(MapPoint, OfAFrame) {
  World world;
  Frame frame = world.MakeFrame({1, 0, 0});
  MapPoint point({1, 0, 4}, world.map(), &frame, 3);  // octave 3: factor 8, the coarsest 128
  EXPECT_EQ(point.mnFirstKFid, -1);
  EXPECT_EQ(point.mnFirstFrame, static_cast<long>(frame.mnId));
  EXPECT_EQ(point.GetReferenceKeyFrame(), nullptr);
  EXPECT_EQ(point.GetNormal(), Eigen::Vector3f(0, 0, 1));
  EXPECT_FLOAT_EQ(point.GetMaxDistanceInvariance(), 1.2F * 4 * 8);
  EXPECT_FLOAT_EQ(point.GetMinDistanceInvariance(), 0.8F * 4 * 8 / 128);
  EXPECT_EQ(FirstByte(point.GetDescriptor()), 3);
}

TEST(MapPoint, OfARightKeypointOfAFrame) {
  World world(Eyes::kFisheyePair);
  Frame frame = world.MakeFrame({1, 0, 0});
  MapPoint point({1.5F, 0, 4}, world.map(), &frame, 22);  // right camera at x = 1.5; octave 22 % 8 = 6
  EXPECT_EQ(point.GetNormal(), Eigen::Vector3f(0, 0, 1));
  EXPECT_FLOAT_EQ(point.GetMaxDistanceInvariance(), 1.2F * 4 * 64);
  EXPECT_EQ(FirstByte(point.GetDescriptor()), 22);
}

TEST(MapPoint, KeepsPositionAndNormal) {
  World world;
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  point->SetWorldPos({7, 8, 9});
  point->SetNormalVector({0, 1, 0});
  EXPECT_EQ(point->GetWorldPos(), Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(point->GetNormal(), Eigen::Vector3f(0, 1, 0));
}

TEST(MapPoint, CountsHowOftenItWasFound) {
  World world;
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  point->IncreaseVisible(7);
  point->IncreaseVisible();  // 9
  point->IncreaseFound(2);
  point->IncreaseFound();  // 4
  EXPECT_EQ(point->GetFound(), 4);
  EXPECT_FLOAT_EQ(point->GetFoundRatio(), 4.0F / 9);
}

TEST(MapPoint, MovesToAnotherMapButKeepsItsOrigin) {
  World world;
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  Map* before = world.map();
  world.atlas.CreateNewMap();
  point->UpdateMap(world.map());
  world.map()->AddMapPoint(point);
  EXPECT_EQ(point->GetMap(), world.map());
  EXPECT_EQ(point->mnOriginMapId, before->GetId());
  EXPECT_EQ(before->MapPointsInMap(), 0U);
  EXPECT_EQ(world.map()->MapPointsInMap(), 1U);
}

TEST(UpdateNormalAndDepth, TakesTheMeanDirectionAndTheReferenceOctave) {
  World world;
  KeyFrame *near = world.AddKeyFrame({0, 0, 0}), *aside = world.AddKeyFrame({4, 0, 4});
  MapPoint* point = world.AddPoint(near, {0, 0, 4});
  World::Observe(point, near, 2);   // octave 2: factor 4
  World::Observe(point, aside, 5);  // sees it along -x
  point->UpdateNormalAndDepth();
  EXPECT_EQ(point->GetNormal(), Eigen::Vector3f(-0.5F, 0, 0.5F)) << "the mean, not a unit vector";
  EXPECT_FLOAT_EQ(point->GetMaxDistanceInvariance(), 1.2F * 4 * 4);
  EXPECT_FLOAT_EQ(point->GetMinDistanceInvariance(), 0.8F * 16 / 128);
}

TEST(UpdateNormalAndDepth, CountsBothCamerasOfAPair) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe, {0.5F, 0, 0.5F});
  World::Observe(point, keyframe, 23);  // right camera, at x = 0.5; octave 7
  point->UpdateNormalAndDepth();
  EXPECT_EQ(point->GetNormal(), Eigen::Vector3f(0, 0, 1));
  EXPECT_FLOAT_EQ(point->GetMaxDistanceInvariance(), 1.2F * std::sqrt(0.5F) * 128) << "from the left camera";
  World::Observe(point, keyframe, 1);  // left too: octave 1 counts now
  point->UpdateNormalAndDepth();
  const Eigen::Vector3f left = Eigen::Vector3f(1, 0, 1).normalized();
  EXPECT_LT((point->GetNormal() - (left + Eigen::Vector3f(0, 0, 1)) / 2).norm(), 1e-6F);
  EXPECT_FLOAT_EQ(point->GetMaxDistanceInvariance(), 1.2F * std::sqrt(0.5F) * 2);
}

TEST(UpdateNormalAndDepth, LeavesPointsWithoutObservations) {
  World world;
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  point->SetNormalVector({0, 1, 0});
  point->UpdateNormalAndDepth();
  EXPECT_EQ(point->GetNormal(), Eigen::Vector3f(0, 1, 0));
}

TEST(PredictScale, IsTheOctaveAtThatDistance) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  Frame frame = world.MakeFrame({0, 0, 0});
  MapPoint* point = world.AddPoint(keyframe, {0, 0, 4});
  World::Observe(point, keyframe, 3);
  point->UpdateNormalAndDepth();  // max = 4 * 8 = 32
  for (const auto& [distance, octave] :
       {std::pair{4.0F, 3}, {3.0F, 4}, {8.0F, 2}, {9.0F, 2}, {32.0F, 0}, {100.0F, 0}, {0.1F, 7}, {0.0F, 7}}) {
    EXPECT_EQ(point->PredictScale(distance, keyframe), octave) << distance;
    EXPECT_EQ(point->PredictScale(distance, &frame), octave) << distance;
  }
}

TEST(ComputeDistinctiveDescriptors, TakesTheLeastMedianDistance) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 5; ++i) keyframes.push_back(world.AddKeyFrame());
  MapPoint* point = world.AddPoint(keyframes[0]);
  // Rows are first bytes: 15 = 1111, 1, 3, 7, 32. Sorted distances of 3 (0011) to all: 0 1 1 2 3, median 1; of 1: 0 1
  // 2 3 2 -> 2; of 7: 0 1 1 2 4 -> 1; of 15: 0 1 2 3 5 -> 2; of 32: 0 2 3 4 5 -> 3. The first of 3 and 7 wins.
  const int rows[] = {15, 1, 3, 7, 32};
  for (std::size_t i = 0; i < 5; ++i) World::Observe(point, keyframes[i], rows[i]);
  point->ComputeDistinctiveDescriptors();
  EXPECT_EQ(FirstByte(point->GetDescriptor()), 3);
  EXPECT_EQ(point->GetDescriptor().cols, 32);
  EXPECT_EQ(point->GetDescriptor().type(), CV_8U);
}

TEST(ComputeDistinctiveDescriptors, GoesByKeyFrameIdWhereEqual) {
  World world;
  KeyFrame *first = world.AddKeyFrame(), *second = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(first);
  World::Observe(point, second, 9);
  World::Observe(point, first, 6);
  point->ComputeDistinctiveDescriptors();
  EXPECT_EQ(FirstByte(point->GetDescriptor()), 6);
}

TEST(ComputeDistinctiveDescriptors, CopiesOutAndNeverShares) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  World::Observe(point, keyframe, 6);
  point->ComputeDistinctiveDescriptors();
  point->GetDescriptor().setTo(255);
  EXPECT_EQ(FirstByte(point->GetDescriptor()), 6);
}

}  // namespace
}  // namespace slamdb::live
