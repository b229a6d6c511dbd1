// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/culling.h"

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

}  // namespace
}  // namespace slamdb::live
