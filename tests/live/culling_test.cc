// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/culling.h"

#include <algorithm>

#include "slamdb/model/preintegration.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A point made by keyframe 0 and seen by `observers` keyframes.
MapPoint* SeenBy(World& world, const std::vector<KeyFrame*>& keyframes, std::size_t observers, int row) {
  MapPoint* point = world.AddPoint(keyframes[0]);
  for (std::size_t i = 0; i < observers; ++i) World::Observe(point, keyframes[i], row);
  return point;
}

class CullMapPoint : public ::testing::Test {
 protected:
  CullMapPoint() {
    for (int i = 0; i < 5; ++i) keyframes.push_back(world.AddKeyFrame());
  }
  World world;
  std::vector<KeyFrame*> keyframes;
};

TEST_F(CullMapPoint, RarelyFound) {
  MapPoint *below = SeenBy(world, keyframes, 4, 0), *at = SeenBy(world, keyframes, 4, 1);
  below->IncreaseVisible(4);  // 1 of 5
  at->IncreaseVisible(3);     // 1 of 4
  EXPECT_EQ(JudgeRecentPoint(*below, 0, true), RecentPoint::kRarelyFound);
  EXPECT_EQ(JudgeRecentPoint(*at, 0, true), RecentPoint::kWatch);
}

TEST_F(CullMapPoint, TwoKeyFramesLaterWithTooFewObservers) {
  MapPoint *two = SeenBy(world, keyframes, 2, 0), *three = SeenBy(world, keyframes, 3, 1),
           *four = SeenBy(world, keyframes, 4, 2);
  EXPECT_EQ(JudgeRecentPoint(*two, 1, true), RecentPoint::kWatch);
  EXPECT_EQ(JudgeRecentPoint(*two, 2, true), RecentPoint::kFewObservers);
  EXPECT_EQ(JudgeRecentPoint(*three, 2, true), RecentPoint::kWatch);
  EXPECT_EQ(JudgeRecentPoint(*three, 2, false), RecentPoint::kFewObservers) << "stereo wants four";
  EXPECT_EQ(JudgeRecentPoint(*four, 2, false), RecentPoint::kWatch);
}

TEST_F(CullMapPoint, SurvivesThreeKeyFrames) {
  MapPoint* point = SeenBy(world, keyframes, 3, 0);
  EXPECT_EQ(JudgeRecentPoint(*point, 3, true), RecentPoint::kKeep);
}

TEST_F(CullMapPoint, GoesThroughTheList) {
  MapPoint *bad = SeenBy(world, keyframes, 3, 0), *replaced = SeenBy(world, keyframes, 3, 1),
           *few = SeenBy(world, keyframes, 2, 2), *watched = SeenBy(world, keyframes, 3, 3);
  bad->SetBadFlag();
  replaced->Replace(watched);
  std::list<MapPoint*> recent = {bad, replaced, few, watched};
  EXPECT_EQ(CullMapPoints(recent, 2, true), 1);
  EXPECT_TRUE(few->isBad());
  EXPECT_THAT(recent, ElementsAre(watched));
  EXPECT_EQ(CullMapPoints(recent, 3, true), 0);
  EXPECT_THAT(recent, IsEmpty());
  EXPECT_FALSE(watched->isBad());
}

TEST(IsRedundant, WantsMoreThanThreeOthersAtAFineOctave) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 5; ++i) keyframes.push_back(world.AddKeyFrame());
  KeyFrame& self = *keyframes[0];
  MapPoint* point = world.AddPoint(&self);
  World::Observe(point, &self, 2);  // octave 2
  for (std::size_t i = 1; i < 4; ++i) World::Observe(point, keyframes[i], 3);
  EXPECT_FALSE(IsRedundant(self, true, 0.9)) << "three others";
  World::Observe(point, keyframes[4], 4);
  EXPECT_FALSE(IsRedundant(self, true, 0.9)) << "the fourth sees it two octaves coarser";
  World::Observe(point, keyframes[4], 3);
  EXPECT_TRUE(IsRedundant(self, true, 0.9));
}

TEST(IsRedundant, LooksAtNearPointsOfDepthSensors) {
  World world(Eyes::kStereo);
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 6; ++i) keyframes.push_back(world.AddKeyFrame());
  MapPoint *near = world.AddPoint(keyframes[0]), *no_depth = world.AddPoint(keyframes[0]);
  for (KeyFrame* keyframe : keyframes) World::Observe(near, keyframe, 2);
  World::Observe(no_depth, keyframes[0], 3);  // seen by nobody else, but odd: without depth
  EXPECT_TRUE(IsRedundant(*keyframes[0], false, 0.9));
  EXPECT_FALSE(IsRedundant(*keyframes[0], true, 0.9)) << "monocular counts both: one of two";
}

TEST(CullKeyFrames, FlagsRedundantCovisibles) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 6; ++i) keyframes.push_back(world.AddKeyFrame());
  world.Share(keyframes, 20, 0);
  world.Share({keyframes[2]}, 10, 20);  // keyframe 2 sees 10 of 30 alone
  for (KeyFrame* keyframe : keyframes) keyframe->UpdateConnections();
  EXPECT_EQ(CullKeyFrames(*keyframes[5], {.monocular = true}), 2) << "then the points have three others only";
  EXPECT_FALSE(keyframes[0]->isBad()) << "the initial one";
  EXPECT_FALSE(keyframes[1]->isBad());
  EXPECT_FALSE(keyframes[2]->isBad());
  EXPECT_TRUE(keyframes[3]->isBad());
  EXPECT_TRUE(keyframes[4]->isBad()) << "covisibles of equal weight come by falling id";
}

TEST(CullKeyFrames, CountsWhatWent) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 7; ++i) keyframes.push_back(world.AddKeyFrame());
  world.Share(keyframes, 20, 0);
  for (KeyFrame* keyframe : keyframes) keyframe->UpdateConnections();
  keyframes[5]->SetNotErase();
  const int culled = CullKeyFrames(*keyframes[6], {.monocular = true});
  const auto bad =
      std::count_if(keyframes.begin(), keyframes.end(), [](KeyFrame* keyframe) { return keyframe->isBad(); });
  EXPECT_GT(culled, 0);
  EXPECT_EQ(culled, bad);
  EXPECT_FALSE(keyframes[5]->isBad()) << "must not be erased now";
  keyframes[5]->SetErase();
  EXPECT_TRUE(keyframes[5]->isBad());
}

// 24 keyframes in a chain of IMU data, which all see the same 20 points: any of them is redundant.
class CullInertialKeyFrames : public ::testing::Test {
 protected:
  static constexpr std::size_t kCount = 24;

  // One measurement of IMU data between keyframes that are `seconds` and `metres` apart.
  int Cull(float seconds, float metres) {
    for (std::size_t i = 0; i < kCount; ++i) {
      KeyFrame* keyframe = world.AddKeyFrame({metres * static_cast<float>(i), 0, 0});
      keyframe->mTimeStamp = static_cast<double>(seconds) * static_cast<double>(i);
      ImuPreintegration imu;
      imu.measurements.push_back({.acceleration = {0, 0, 9.81F}, .angular_velocity = {0, 0, 0}, .duration = seconds});
      Reintegrate(imu, {});
      keyframe->SetImuPreintegrated(imu);
      keyframes.push_back(keyframe);
    }
    for (std::size_t i = 1; i < kCount; ++i) {
      keyframes[i]->mPrevKF = keyframes[i - 1];
      keyframes[i - 1]->mNextKF = keyframes[i];
    }
    world.Share(keyframes, 20, 0);
    for (KeyFrame* keyframe : keyframes) keyframe->UpdateConnections();
    return CullKeyFrames(*keyframes.back(), {.monocular = true, .inertial = true});
  }

  World world;
  std::vector<KeyFrame*> keyframes;
};

TEST_F(CullInertialKeyFrames, ShortGapsUntil21AreLeft) {
  EXPECT_EQ(Cull(0.1F, 0.1F), 3);
  EXPECT_FALSE(keyframes[22]->isBad()) << "the one before the current stays";
  EXPECT_FALSE(keyframes[18]->isBad());
  for (const std::size_t culled : {19, 20, 21}) {
    EXPECT_TRUE(keyframes[culled]->isBad()) << culled;
    EXPECT_EQ(keyframes[culled]->mPrevKF, nullptr);
    EXPECT_EQ(keyframes[culled]->mNextKF, nullptr);
  }
  EXPECT_EQ(keyframes[22]->mPrevKF, keyframes[18]);
  EXPECT_EQ(keyframes[18]->mNextKF, keyframes[22]);
  const ImuPreintegration joined = keyframes[22]->GetImuPreintegrated();
  EXPECT_EQ(joined.measurements.size(), 4U) << "its own and those of the three";
  EXPECT_NEAR(joined.duration, 0.4F, 1e-6F);
}

TEST_F(CullInertialKeyFrames, LongGapsStay) { EXPECT_EQ(Cull(1, 0.1F), 0); }

TEST_F(CullInertialKeyFrames, GapsOfLessThanThreeSecondsAtAStandstill) {
  EXPECT_EQ(Cull(1, 0), 3);
  for (const std::size_t culled : {17, 19, 21}) EXPECT_TRUE(keyframes[culled]->isBad()) << culled;
  EXPECT_EQ(keyframes[22]->mPrevKF, keyframes[20]) << "without 20 there would be three seconds between 19 and 22";
}

TEST_F(CullInertialKeyFrames, NoStandstillAfterTheSecondAdjustment) {
  world.map()->SetIniertialBA2();
  EXPECT_EQ(Cull(1, 0), 0);
}

TEST_F(CullInertialKeyFrames, OldOnesOfAnInitialisedMap) {
  world.map()->SetImuInitialized();
  EXPECT_EQ(Cull(1, 0.1F), 1);
  EXPECT_TRUE(keyframes[1]->isBad()) << "older than the 21 before the current";
}

}  // namespace
}  // namespace slamdb::live
