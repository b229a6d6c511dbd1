// SPDX-License-Identifier: BSD-3-Clause
// MapPoint: observations, going bad, being replaced, PreSave and PostLoad.
#include <sstream>

#include "slamdb/base/error.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

std::tuple<int, int> Rows(int left, int right) { return {left, right}; }

TEST(AddObservation, OfOneCameraCountsOne) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(a);
  point->AddObservation(a, 4);
  point->AddObservation(b, 6);
  EXPECT_EQ(point->Observations(), 2);
  EXPECT_EQ(point->nObs, 2);
  EXPECT_THAT(point->GetObservations(), UnorderedElementsAre(Pair(a, Rows(4, -1)), Pair(b, Rows(6, -1))));
  EXPECT_EQ(point->GetIndexInKeyFrame(b), Rows(6, -1));
  EXPECT_TRUE(point->IsInKeyFrame(a));
  EXPECT_EQ(a->GetMapPoint(4), nullptr) << "the keyframe's side is the caller's";
}

TEST(AddObservation, WithDepthCountsTwo) {
  World world(Eyes::kStereo);
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(a);
  point->AddObservation(a, 4);  // even: has a right match
  EXPECT_EQ(point->Observations(), 2);
  point->AddObservation(b, 5);  // odd: has none
  EXPECT_EQ(point->Observations(), 3);
}

TEST(AddObservation, CountsEachImageOfAPair) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  point->AddObservation(keyframe, 25);
  EXPECT_EQ(point->Observations(), 1);
  EXPECT_EQ(point->GetIndexInKeyFrame(keyframe), Rows(-1, 25));
  point->AddObservation(keyframe, 3);
  EXPECT_EQ(point->Observations(), 2);
  EXPECT_EQ(point->GetIndexInKeyFrame(keyframe), Rows(3, 25));
}

TEST(AddObservation, AgainDoesNotCountAgain) {
  World world(Eyes::kStereo);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  point->AddObservation(keyframe, 4);
  point->AddObservation(keyframe, 4);
  EXPECT_EQ(point->Observations(), 2);
  point->AddObservation(keyframe, 5);  // moves to a keypoint without depth
  EXPECT_EQ(point->Observations(), 1);
}

TEST(AddObservation, OfAKeypointThatIsNotThereIsRefused) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  for (const int row : {-1, World::kFeatures}) EXPECT_THROW(point->AddObservation(keyframe, row), Error);
  EXPECT_FALSE(point->IsInKeyFrame(keyframe));
}

TEST(EraseObservation, TakesBackWhatItCountedAndMovesTheReference) {
  World world(Eyes::kStereo);
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *c = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(c);
  for (KeyFrame* keyframe : {c, b, a}) World::Observe(point, keyframe, 4);
  EXPECT_EQ(point->Observations(), 6);
  point->EraseObservation(c);
  EXPECT_EQ(point->Observations(), 4);
  EXPECT_EQ(point->GetReferenceKeyFrame(), a) << "the observer of the lowest id";
  EXPECT_FALSE(point->IsInKeyFrame(c));
  EXPECT_EQ(point->GetIndexInKeyFrame(c), Rows(-1, -1));
  EXPECT_FALSE(point->isBad());
  point->EraseObservation(c);
  EXPECT_EQ(point->Observations(), 4) << "it was not there";
}

TEST(EraseObservation, FlagsAPointWithTwoLeft) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 4; ++i) keyframes.push_back(world.AddKeyFrame());
  MapPoint* point = world.AddPoint(keyframes[0]);
  for (KeyFrame* keyframe : keyframes) World::Observe(point, keyframe, 7);
  point->EraseObservation(keyframes[3]);
  EXPECT_FALSE(point->isBad()) << "three left";
  point->EraseObservation(keyframes[2]);
  EXPECT_TRUE(point->isBad());
  EXPECT_EQ(point->Observations(), 2) << "the count stays";
  EXPECT_THAT(point->GetObservations(), IsEmpty());
  EXPECT_EQ(keyframes[0]->GetMapPoint(7), nullptr);
  EXPECT_EQ(keyframes[1]->GetMapPoint(7), nullptr);
  EXPECT_EQ(world.map()->MapPointsInMap(), 0U);
  EXPECT_EQ(point->GetReferenceKeyFrame(), keyframes[0]) << "the object lives on";
}

TEST(EraseObservation, OfTheLastOneLeavesNoReference) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  World::Observe(point, keyframe, 7);
  point->EraseObservation(keyframe);
  EXPECT_EQ(point->GetReferenceKeyFrame(), nullptr);
  EXPECT_TRUE(point->isBad());
}

TEST(SetBadFlag, ClearsBothSlotsOfAPair) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  World::Observe(point, keyframe, 3);
  World::Observe(point, keyframe, 25);
  EXPECT_EQ(keyframe->GetNumberMPs(), 2);
  point->SetBadFlag();
  EXPECT_TRUE(point->isBad());
  EXPECT_EQ(keyframe->GetNumberMPs(), 0);
  EXPECT_EQ(world.map()->MapPointsInMap(), 0U);
  point->SetBadFlag();
  point->ComputeDistinctiveDescriptors();
  point->UpdateNormalAndDepth();
  EXPECT_TRUE(point->GetDescriptor().empty());
}

TEST(Replace, MovesObservationsCountersAndDescriptor) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *both = world.AddKeyFrame();
  MapPoint *old_point = world.AddPoint(a), *new_point = world.AddPoint(b, {9, 9, 9});
  World::Observe(old_point, a, 5);
  World::Observe(old_point, both, 6);
  World::Observe(new_point, b, 5);
  World::Observe(new_point, both, 8);
  old_point->IncreaseVisible(9);  // 10
  old_point->IncreaseFound(4);    // 5
  old_point->Replace(new_point);

  EXPECT_TRUE(old_point->isBad());
  EXPECT_EQ(old_point->GetReplaced(), new_point);
  EXPECT_THAT(old_point->GetObservations(), IsEmpty());
  EXPECT_THAT(new_point->GetObservations(),
              UnorderedElementsAre(Pair(a, Rows(5, -1)), Pair(b, Rows(5, -1)), Pair(both, Rows(8, -1))));
  EXPECT_EQ(new_point->Observations(), 3);
  EXPECT_EQ(a->GetMapPoint(5), new_point);
  EXPECT_EQ(both->GetMapPoint(6), nullptr) << "it sees the new point already";
  EXPECT_EQ(both->GetMapPoint(8), new_point);
  EXPECT_EQ(new_point->GetFound(), 6);
  EXPECT_FLOAT_EQ(new_point->GetFoundRatio(), 6.0F / 11);
  EXPECT_EQ(new_point->GetDescriptor().at<std::uint8_t>(0, 0), 5) << "recomputed";
  EXPECT_EQ(new_point->GetWorldPos(), Eigen::Vector3f(9, 9, 9)) << "not averaged";
  EXPECT_THAT(world.map()->GetAllMapPoints(), ElementsAre(new_point));
}

TEST(Replace, TransfersBothImagesOfAPair) {
  World world(Eyes::kFisheyePair);
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  MapPoint *old_point = world.AddPoint(a), *new_point = world.AddPoint(b);
  World::Observe(old_point, a, 5);
  World::Observe(old_point, a, 30);
  old_point->Replace(new_point);
  EXPECT_EQ(new_point->GetIndexInKeyFrame(a), Rows(5, 30));
  EXPECT_EQ(new_point->Observations(), 2);
  EXPECT_EQ(a->GetMapPoint(30), new_point);
}

TEST(Replace, ByItselfDoesNothing) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  World::Observe(point, keyframe, 5);
  point->Replace(point);
  EXPECT_FALSE(point->isBad());
  EXPECT_TRUE(point->IsInKeyFrame(keyframe));
}

TEST(PrintObservations, NamesTheKeyFrames) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  World::Observe(point, keyframe, 5);
  std::ostringstream out;
  point->PrintObservations(out);
  EXPECT_EQ(out.str(), "MP_OBS: MP 0\n--OBS in KF 0 in map 0\n");
}

TEST(PreSave, FillsTheBackupMembersAndChangesNothingElse) {
  World world(Eyes::kFisheyePair);
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *elsewhere = world.AddKeyFrame();
  MapPoint *point = world.AddPoint(b), *other = world.AddPoint(a);
  World::Observe(point, a, 5);
  World::Observe(point, b, 27);
  World::Observe(point, elsewhere, 8);
  std::set<KeyFrame*> keyframes = {a, b};
  std::set<MapPoint*> points = {point};
  point->PreSave(keyframes, points);
  EXPECT_THAT(point->mBackupObservationsId1, ElementsAre(Pair(a->mnId, 5), Pair(b->mnId, -1)));
  EXPECT_THAT(point->mBackupObservationsId2, ElementsAre(Pair(a->mnId, -1), Pair(b->mnId, 27)));
  EXPECT_EQ(point->mBackupRefKFId, b->mnId);
  EXPECT_EQ(point->mBackupReplacedId, -1);
  EXPECT_TRUE(point->IsInKeyFrame(elsewhere));
  point->Replace(other);
  std::set<MapPoint*> both = {point, other};
  point->PreSave(keyframes, both);
  EXPECT_EQ(point->mBackupReplacedId, static_cast<long long>(other->mnId));
}

TEST(PostLoad, FindsTheTargetsAndReportsThoseThatAreNotThere) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(a);
  point->mBackupObservationsId1 = {{a->mnId, 3}, {b->mnId, 4}, {77, 5}};
  point->mBackupObservationsId2 = {{a->mnId, -1}, {b->mnId, -1}, {77, -1}};
  point->mBackupRefKFId = b->mnId;
  point->mBackupReplacedId = 99;
  std::map<long unsigned int, KeyFrame*> keyframes = {{a->mnId, a}, {b->mnId, b}};
  std::map<long unsigned int, MapPoint*> points = {{point->mnId, point}};
  const PostLoadReport report = point->PostLoad(keyframes, points);
  EXPECT_THAT(point->GetObservations(), UnorderedElementsAre(Pair(a, Rows(3, -1)), Pair(b, Rows(4, -1))));
  EXPECT_EQ(point->GetReferenceKeyFrame(), b);
  EXPECT_EQ(report[LinkKind::kObservation], 1U);
  EXPECT_EQ(report[LinkKind::kReplacement], 1U);
  EXPECT_EQ(report.dangling(), 2U);
}

TEST(PostLoad, ClearsTheBackupMembers) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint *point = world.AddPoint(keyframe), *other = world.AddPoint(keyframe);
  point->mBackupObservationsId1 = {{keyframe->mnId, 3}};
  point->mBackupObservationsId2 = {{keyframe->mnId, -1}};
  point->mBackupRefKFId = keyframe->mnId;
  point->mBackupReplacedId = static_cast<long long>(other->mnId);
  std::map<long unsigned int, KeyFrame*> keyframes = {{keyframe->mnId, keyframe}};
  std::map<long unsigned int, MapPoint*> points = {{other->mnId, other}};
  EXPECT_TRUE(point->PostLoad(keyframes, points).whole());
  EXPECT_EQ(point->GetReplaced(), other);
  EXPECT_THAT(point->mBackupObservationsId1, IsEmpty());
  EXPECT_THAT(point->mBackupObservationsId2, IsEmpty());
  EXPECT_EQ(point->mBackupRefKFId, KeyFrameId::kNone);
  EXPECT_EQ(point->mBackupReplacedId, -1);
}

TEST(PostLoad, WorksWithoutAMap) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
  point->UpdateMap(nullptr);
  point->mBackupObservationsId1 = {{77, 3}};
  std::map<long unsigned int, KeyFrame*> keyframes = {{keyframe->mnId, keyframe}};
  std::map<long unsigned int, MapPoint*> points;
  const PostLoadReport report = point->PostLoad(keyframes, points);
  EXPECT_EQ(report[LinkKind::kObservation], 1U);
  EXPECT_EQ(report.examples.front().map, MapId()) << "of no map";
}

}  // namespace
}  // namespace slamdb::live
