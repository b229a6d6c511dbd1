// SPDX-License-Identifier: BSD-3-Clause
// PreSave and PostLoad of keyframes, maps and atlases. Those of points: observations_test.cc.
#include <set>

#include "slamdb/live/bridge.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/live/kinds.h"
#include "tests/live/world.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

TEST(Backup, OfAWholeAtlasComesBackAsItWas) {
  for (const SyntheticOptions& kind : Kinds()) {
    const slamdb::Atlas model = SynthesizeAtlas(kind);
    const LiveAtlas live = FromModel(model);
    live.atlas->PreSave();
    EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model)) << "PreSave changes nothing";
    const PostLoadReport report = live.atlas->PostLoad();
    EXPECT_TRUE(report.whole()) << report.ToString();
    EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model));
    for (Map* map : live.atlas->GetAllMaps()) {
      EXPECT_THAT(map->mvpBackupKeyFrames, IsEmpty());
      EXPECT_THAT(map->mvBackupKeyFrameOriginsId, IsEmpty());
    }
    EXPECT_TRUE(live.atlas->PostLoad().whole());
    EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model)) << "a second one finds nothing to do";
  }
}

// Two keyframes that are linked in every way, and one outside the sets.
class KeyFrameBackup : public ::testing::Test {
 protected:
  KeyFrameBackup() {
    outside->AddConnection(self, 3);
    self->AddConnection(outside, 3);
    self->AddConnection(other, 20);
    self->ChangeParent(other);
    self->AddChild(outside);
    other->AddChild(self);
    self->AddLoopEdge(other);
    self->AddMergeEdge(other);
    self->AddMergeEdge(outside);
    self->mPrevKF = other;
    self->mNextKF = outside;
    self->AddMapPoint(point, 4);
    self->AddMapPoint(point_outside, 5);
  }

  World world;
  KeyFrame *other = world.AddKeyFrame(), *self = world.AddKeyFrame(), *outside = world.AddKeyFrame();
  MapPoint *point = world.AddPoint(other), *point_outside = world.AddPoint(other);
  std::set<KeyFrame*> keyframes = {other, self, nullptr};
  std::set<MapPoint*> points = {point, nullptr};
  std::set<GeometricCamera*> cameras = {world.left, nullptr};
  std::map<long unsigned int, KeyFrame*> keyframe_by_id = {{other->mnId, other}, {self->mnId, self}, {99, nullptr}};
  std::map<long unsigned int, MapPoint*> point_by_id = {{point->mnId, point}};
  std::map<unsigned int, GeometricCamera*> camera_by_id = {{world.left->GetId(), world.left}};
};

TEST_F(KeyFrameBackup, PreSaveFillsTheMembersFromTheSets) {
  self->PreSave(keyframes, points, cameras);
  ASSERT_THAT(self->mvBackupMapPointsId, SizeIs(World::kFeatures));
  EXPECT_EQ(self->mvBackupMapPointsId[4], static_cast<long long>(point->mnId));
  EXPECT_EQ(self->mvBackupMapPointsId[5], -1) << "not in the set";
  EXPECT_EQ(self->mvBackupMapPointsId[6], -1);
  EXPECT_THAT(self->mBackupConnectedKeyFrameIdWeights, ElementsAre(Pair(other->mnId, 20)));
  EXPECT_EQ(self->mBackupParentId, static_cast<long long>(other->mnId));
  EXPECT_THAT(self->mvBackupChildrensId, IsEmpty());
  EXPECT_THAT(self->mvBackupLoopEdgesId, ElementsAre(other->mnId));
  EXPECT_THAT(self->mvBackupMergeEdgesId, ElementsAre(other->mnId));
  EXPECT_EQ(self->mBackupPrevKFId, static_cast<long long>(other->mnId));
  EXPECT_EQ(self->mBackupNextKFId, -1);
  EXPECT_EQ(self->mnBackupIdCamera, world.left->GetId());
  EXPECT_EQ(self->mnBackupIdCamera2, ~0U);
  EXPECT_EQ(self->GetWeight(outside), 3) << "nothing is erased";
  EXPECT_EQ(self->GetMapPoint(5), point_outside);
}

TEST_F(KeyFrameBackup, PostLoadFindsTheTargetsAndClearsTheMembers) {
  self->PreSave(keyframes, points, cameras);
  const PostLoadReport report = self->PostLoad(keyframe_by_id, point_by_id, camera_by_id);
  EXPECT_TRUE(report.whole()) << report.ToString();
  EXPECT_EQ(self->GetMapPoint(4), point);
  EXPECT_EQ(self->GetMapPoint(5), nullptr) << "the links of the backup replace those it had";
  EXPECT_EQ(self->GetWeight(other), 20);
  EXPECT_EQ(self->GetWeight(outside), 0);
  EXPECT_THAT(self->GetVectorCovisibleKeyFrames(), ElementsAre(other));
  EXPECT_EQ(self->GetParent(), other);
  EXPECT_THAT(self->GetLoopEdges(), ElementsAre(other));
  EXPECT_THAT(self->GetMergeEdges(), ElementsAre(other));
  EXPECT_EQ(self->mPrevKF, other);
  EXPECT_EQ(self->mNextKF, nullptr);
  EXPECT_EQ(self->mpCamera, world.left);
  EXPECT_THAT(self->mvBackupMapPointsId, IsEmpty());
  EXPECT_THAT(self->mBackupConnectedKeyFrameIdWeights, IsEmpty());
  EXPECT_THAT(self->mvBackupLoopEdgesId, IsEmpty());
  EXPECT_EQ(self->mBackupParentId, -1);
  EXPECT_EQ(self->mnBackupIdCamera, ~0U);
}

TEST_F(KeyFrameBackup, PostLoadReportsWhatIsNotThere) {
  self->mvBackupMapPointsId = {-1, 77};  // and none for the other rows
  self->mBackupConnectedKeyFrameIdWeights = {{other->mnId, 15}, {77, 16}, {99, 17}};
  self->mBackupParentId = 78;
  self->mvBackupChildrensId = {79};
  self->mnBackupIdCamera = 55;
  const PostLoadReport report = self->PostLoad(keyframe_by_id, point_by_id, camera_by_id);
  EXPECT_EQ(report[LinkKind::kSlot], 1U);
  EXPECT_EQ(report[LinkKind::kConnection], 2U) << "what is not there, and a null pointer";
  EXPECT_EQ(report[LinkKind::kParent], 1U);
  EXPECT_EQ(report[LinkKind::kChild], 1U);
  EXPECT_EQ(report[LinkKind::kCamera], 1U);
  EXPECT_EQ(report.dangling(), 6U);
  EXPECT_EQ(self->mpCamera, nullptr);
  EXPECT_EQ(self->GetParent(), nullptr);
  EXPECT_EQ(self->GetMapPoint(4), nullptr);
}

TEST_F(KeyFrameBackup, PostLoadWorksWithoutAMap) {
  self->UpdateMap(nullptr);
  self->mBackupParentId = 78;
  EXPECT_EQ(self->PostLoad(keyframe_by_id, point_by_id, camera_by_id)[LinkKind::kParent], 1U);
}

TEST(MapBackup, TakesInWhatAProgramReadByItself) {
  struct Database : KeyFrameDatabase {
    void add(KeyFrame* pKF) override { known.push_back(pKF); }
    void erase(KeyFrame*) override {}
    std::vector<KeyFrame*> known;
  } database;
  World world, elsewhere;
  Map* map = world.map();
  Frame frame = world.MakeFrame({0, 0, 0});
  auto* keyframe = new KeyFrame(frame, map);
  auto* point = new MapPoint();  // as an archive fills it
  point->mnId = 57;
  point->mBackupObservationsId1 = {{keyframe->mnId, 3}};
  point->mBackupObservationsId2 = {{keyframe->mnId, -1}};
  point->mBackupRefKFId = keyframe->mnId;
  point->SetWorldPos({1, 2, 3});
  std::set<GeometricCamera*> cameras = {world.left};
  std::set<KeyFrame*> keyframes;
  std::set<MapPoint*> points;
  keyframe->PreSave(keyframes, points, cameras);
  keyframe->mvBackupMapPointsId[3] = 57;
  map->mvpBackupKeyFrames = {keyframe, nullptr, elsewhere.AddKeyFrame()};
  map->mvpBackupMapPoints = {point, nullptr, elsewhere.AddPoint(elsewhere.AddKeyFrame())};
  map->mvBackupKeyFrameOriginsId = {keyframe->mnId, 99};
  map->mnBackupKFinitialID = map->mnBackupKFlowerID = keyframe->mnId;
  std::map<unsigned int, GeometricCamera*> camera_by_id = {{world.left->GetId(), world.left}};

  const PostLoadReport report = map->PostLoad(&database, nullptr, camera_by_id);
  EXPECT_EQ(report.dangling(), 1U) << report.ToString();
  EXPECT_EQ(report[LinkKind::kOrigin], 1U);
  EXPECT_THAT(map->GetAllKeyFrames(), ElementsAre(keyframe));
  EXPECT_THAT(map->GetAllMapPoints(), ElementsAre(point));
  EXPECT_EQ(point->GetMap(), map);
  EXPECT_EQ(point->GetReferenceKeyFrame(), keyframe);
  EXPECT_EQ(keyframe->GetMapPoint(3), point);
  EXPECT_THAT(map->mvpKeyFrameOrigins, ElementsAre(keyframe));
  EXPECT_EQ(map->GetOriginKF(), keyframe);
  EXPECT_THAT(database.known, ElementsAre(keyframe));
  const MapPoint next({0, 0, 0}, keyframe, map);
  EXPECT_EQ(next.mnId, 58U) << "new ids come behind those that came in";
}

TEST(MapPoint, ByDefaultIsOfNoAtlas) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  auto* point = new MapPoint();
  EXPECT_EQ(point->GetMap(), nullptr);
  EXPECT_EQ(point->GetFound(), 1);
  EXPECT_EQ(point->mnId, MapPointId::kNone);
  point->SetWorldPos({1, 2, 3});
  point->ComputeDistinctiveDescriptors();
  point->UpdateNormalAndDepth();
  EXPECT_EQ(KindOf([&] { point->AddObservation(keyframe, 1); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { world.map()->AddMapPoint(point); }), ErrorKind::kUsage);
  point->UpdateMap(world.map());
  EXPECT_EQ(point->mnId, 0U) << "an id of the atlas";
  point->AddObservation(keyframe, 1);
  world.atlas.AddMapPoint(point);
  EXPECT_EQ(point->GetWorldPos(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(world.map()->MapPointsInMap(), 1U);
  MapPoint unused;
  unused.SetBadFlag();
  EXPECT_TRUE(unused.isBad());
}

}  // namespace
}  // namespace slamdb::live
