// SPDX-License-Identifier: BSD-3-Clause
// Map and Atlas.
#include "slamdb/live/atlas.h"

#include <filesystem>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/live/bridge.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/live/world.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Map, FollowsItsKeyFrames) {
  World world;
  Map* map = world.map();
  EXPECT_EQ(map->GetOriginKF(), nullptr);
  world.atlas.runtime().keyframe_ids.Set(5, 0);
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *c = world.AddKeyFrame();
  EXPECT_EQ(map->GetInitKFid(), 5U);
  EXPECT_EQ(map->GetOriginKF(), a);
  EXPECT_EQ(map->GetMaxKFid(), 7U);
  EXPECT_EQ(map->GetLowerKFID(), 5U);
  map->EraseKeyFrame(a);
  EXPECT_EQ(map->GetLowerKFID(), 6U);
  EXPECT_EQ(map->GetOriginKF(), a) << "never changes";
  map->EraseKeyFrame(c);
  EXPECT_EQ(map->GetMaxKFid(), 7U) << "never decreases";
  EXPECT_THAT(map->GetAllKeyFrames(), ElementsAre(b));
  map->EraseKeyFrame(b);
  EXPECT_EQ(map->KeyFramesInMap(), 0U);
  map->AddKeyFrame(c);
  EXPECT_EQ(map->GetOriginKF(), c) << "the first one again";
}

TEST(Map, CountsChangesAndKeepsFlags) {
  World world;
  Map* map = world.map();
  map->InformNewBigChange();
  map->IncreaseChangeIndex();
  map->SetLastMapChange(7);
  EXPECT_EQ(map->GetLastBigChangeIdx(), 1);
  EXPECT_EQ(map->GetMapChangeIndex(), 1);
  EXPECT_EQ(map->GetLastMapChange(), 7);
  EXPECT_FALSE(map->IsInertial() || map->isImuInitialized() || map->GetIniertialBA1() || map->GetIniertialBA2());
  map->SetInertialSensor();
  map->SetImuInitialized();
  map->SetIniertialBA1();
  map->SetIniertialBA2();
  EXPECT_TRUE(map->IsInertial() && map->isImuInitialized() && map->GetIniertialBA1() && map->GetIniertialBA2());
  MapPoint* point = world.AddPoint(world.AddKeyFrame());
  map->SetReferenceMapPoints({point});
  EXPECT_THAT(map->GetReferenceMapPoints(), ElementsAre(point));
}

TEST(Map, ClearsItself) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  world.AddPoint(keyframe);
  world.map()->SetImuInitialized();
  world.atlas.clearMap();
  EXPECT_EQ(world.atlas.KeyFramesInMap(), 0U);
  EXPECT_EQ(world.atlas.MapPointsInMap(), 0U);
  EXPECT_EQ(keyframe->GetMap(), nullptr);
  EXPECT_FALSE(world.map()->isImuInitialized());
  keyframe->UpdateConnections();
  keyframe->SetBadFlag();
}

TEST(Map, MovesAndScales) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame({1, 0, 0});
  keyframe->SetVelocity({1, 0, 0});
  MapPoint* point = world.AddPoint(keyframe, {1, 0, 4});
  World::Observe(point, keyframe, 1);
  point->UpdateNormalAndDepth();
  const Rigid3f quarter_turn{Quaternionf(Eigen::AngleAxisf(static_cast<float>(M_PI) / 2, Eigen::Vector3f::UnitZ())),
                             {0, 0, 10}};
  world.map()->ApplyScaledRotation(quarter_turn, 2, true);
  EXPECT_LT((keyframe->GetCameraCenter() - Eigen::Vector3f(0, 2, 10)).norm(), 1e-5F);
  EXPECT_LT((point->GetWorldPos() - Eigen::Vector3f(0, 2, 18)).norm(), 1e-5F);
  EXPECT_LT((keyframe->GetVelocity() - Eigen::Vector3f(0, 2, 0)).norm(), 1e-5F);
  EXPECT_NEAR(point->GetMaxDistanceInvariance(), 1.2F * 8 * 2, 1e-4F);
  EXPECT_EQ(world.map()->GetMapChangeIndex(), 1);
}

TEST(Map, ListsWhatIsAddedInOrder) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  std::vector<MapPoint*> points;
  for (int i = 0; i < 500; ++i) points.push_back(world.AddPoint(keyframe));
  for (int i = 0; i < 500; i += 3) world.map()->EraseMapPoint(points[static_cast<std::size_t>(i)]);
  for (int i = 1; i < 500; i += 3) world.map()->EraseMapPoint(points[static_cast<std::size_t>(i)]);
  world.map()->AddMapPoint(points[0]);
  std::vector<MapPoint*> expected;
  for (std::size_t i = 2; i < 500; i += 3) expected.push_back(points[i]);
  expected.push_back(points[0]);
  EXPECT_EQ(world.map()->GetAllMapPoints(), expected);
}

TEST(Atlas, BeginsMaps) {
  Atlas atlas;
  EXPECT_EQ(atlas.CountMaps(), 0);
  Map* first = atlas.GetCurrentMap();
  EXPECT_EQ(atlas.CountMaps(), 1) << "made on demand";
  EXPECT_TRUE(first->IsInUse());
  atlas.CreateNewMap();
  Map* second = atlas.GetCurrentMap();
  EXPECT_FALSE(first->IsInUse());
  EXPECT_EQ(second->GetId(), first->GetId() + 1);
  EXPECT_THAT(atlas.GetAllMaps(), ElementsAre(first, second));
  atlas.ChangeMap(first);
  EXPECT_EQ(atlas.GetCurrentMap(), first);
  EXPECT_TRUE(first->IsInUse());
  first->ChangeId(9);
  EXPECT_THAT(atlas.GetAllMaps(), ElementsAre(second, first)) << "by id";
}

TEST(Atlas, NumbersTheInitialKeyFrameOfANewMap) {
  World world;
  for (int i = 0; i < 4; ++i) world.AddKeyFrame();
  world.atlas.CreateNewMap();
  EXPECT_EQ(world.atlas.GetLastInitKFid(), 4U);
  EXPECT_EQ(world.map()->GetInitKFid(), 4U);
  KeyFrame* keyframe = world.AddKeyFrame();
  EXPECT_EQ(keyframe->mnId, 4U) << "ids go on through all maps";
}

TEST(Atlas, RemovesBadMaps) {
  World world;
  Map* first = world.map();
  world.AddPoint(world.AddKeyFrame());
  world.atlas.CreateNewMap();
  KeyFrame* keyframe = world.AddKeyFrame();
  world.atlas.SetMapBad(first);
  EXPECT_TRUE(first->IsBad());
  EXPECT_EQ(world.atlas.CountMaps(), 1);
  world.atlas.RemoveBadMaps();
  EXPECT_THAT(world.atlas.GetAllKeyFrames(), ElementsAre(keyframe));
  EXPECT_THAT(ToModel(world.atlas).maps, SizeIs(1));
  world.atlas.clearAtlas();
  EXPECT_EQ(world.atlas.CountMaps(), 0);
}

// After a merge, what was culled before it is still linked to from what moved.
TEST(Atlas, KeepsCulledObjectsThatOthersLinkTo) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 12, .points = 300}));
  Atlas& atlas = *live.atlas;
  Map* before = atlas.GetAllMaps().front();
  const std::vector<KeyFrame*> keyframes = before->GetAllKeyFrames();
  for (std::size_t i = 2; i + 1 < keyframes.size(); i += 3) {
    keyframes[i + 1]->mPrevKF = keyframes[i];
    keyframes[i]->SetBadFlag();
  }
  before->GetAllMapPoints()[4]->SetBadFlag();
  const slamdb::Atlas expected = ToModel(atlas);
  atlas.CreateNewMap();
  Map* now = atlas.GetCurrentMap();
  for (KeyFrame* keyframe : before->GetAllKeyFrames()) now->AddKeyFrame(keyframe);
  for (MapPoint* point : before->GetAllMapPoints()) now->AddMapPoint(point);
  EXPECT_EQ(now->GetAllMapPoints().front()->GetMap(), now) << "adding moves";
  atlas.SetMapBad(before);
  atlas.RemoveBadMaps();
  const slamdb::Atlas merged = ToModel(atlas);
  ASSERT_THAT(merged.maps, SizeIs(1));
  EXPECT_EQ(merged.maps[0].keyframes.size(), expected.maps[0].keyframes.size());
  for (const RuleResult& result : CheckAtlas(merged, {}).results)
    EXPECT_NE(result.severity, Severity::kError) << result.id << ": " << result.findings.front().message;
  for (KeyFrame* keyframe : now->GetAllKeyFrames()) keyframe->UpdateConnections();
  atlas.clearAtlas();
}

TEST(Atlas, KnowsTheLowestOfWhatIsLeft) {
  World world;
  Map* before = world.map();
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 4; ++i) keyframes.push_back(world.AddKeyFrame());
  world.atlas.CreateNewMap();
  for (int i = 0; i < 2; ++i) world.map()->AddKeyFrame(keyframes[static_cast<std::size_t>(i)]);
  EXPECT_EQ(before->GetLowerKFID(), 2U);
  EXPECT_EQ(before->GetOriginKF(), keyframes[2]);
  EXPECT_EQ(world.map()->GetLowerKFID(), 0U);
  const slamdb::Atlas model = ToModel(world.atlas);
  EXPECT_EQ(model.maps[0].lowest_keyframe, KeyFrameId(2));
  EXPECT_EQ(model.maps[0].first_keyframe, KeyFrameId(2));
}

TEST(Atlas, MakesNoMapWhenItIsAsked) {
  Atlas atlas;
  EXPECT_EQ(atlas.KeyFramesInMap(), 0U);
  EXPECT_THAT(atlas.GetAllMapPoints(), SizeIs(0));
  EXPECT_FALSE(atlas.isInertial());
  EXPECT_EQ(atlas.CountMaps(), 0);
}

TEST(Atlas, HandsOutNoIdThatAMapWasGiven) {
  World world;
  world.map()->ChangeId(3);
  for (int i = 0; i < 3; ++i) world.atlas.CreateNewMap();
  std::set<long unsigned int> ids;
  for (Map* map : world.atlas.GetAllMaps()) EXPECT_TRUE(ids.insert(map->GetId()).second) << map->GetId();
}

TEST(Atlas, IsReadWhole) {
  EXPECT_THROW(static_cast<void>(Atlas::Load("any.osa", {.features = FeatureColumns::kNone})), Error);
  EXPECT_THROW(static_cast<void>(Atlas::Load("any.osa", {.selection = {.first_keyframe = 3}})), Error);
}

TEST(Atlas, KeepsOneOfEqualCameras) {
  Atlas atlas;
  GeometricCamera* first = atlas.AddCamera(new Pinhole({100, 100, 320, 240}));
  EXPECT_EQ(atlas.AddCamera(new Pinhole({100, 100, 320, 240})), first);
  GeometricCamera* other = atlas.AddCamera(new Pinhole({101, 100, 320, 240}));
  EXPECT_NE(other, first);
  EXPECT_EQ(atlas.AddCamera(other), other);
  EXPECT_NE(atlas.AddCamera(new KannalaBrandt8({100, 100, 320, 240, 0, 0, 0, 0})), first);
  EXPECT_THAT(atlas.GetAllCameras(), SizeIs(3));
  EXPECT_EQ(first->GetId(), 0U);
  EXPECT_EQ(other->GetId(), 1U);
}

TEST(Atlas, LivesBesideAnother) {
  World one, other;
  EXPECT_EQ(one.AddKeyFrame()->mnId, 0U);
  EXPECT_EQ(other.AddKeyFrame()->mnId, 0U) << "ids are not static";
}

// The story of two sessions, in each format that holds everything.
TEST(Atlas, SavesAndLoads) {
  const TemporaryFolder folder;
  for (const char* name : {"session.osa", "session.db#lab"}) {
    const std::string location = folder / name;
    const LiveAtlas first =
        FromModel(SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 6, .points = 150, .features = 200}));
    first.atlas->Save(location);
    EXPECT_THROW(first.atlas->Save(location), Error) << "there already";
    const slamdb::Atlas saved = ToModel(*first.atlas);

    Atlas::Loaded second = Atlas::Load(location);
    EXPECT_TRUE(second.report.whole());
    EXPECT_THAT(ToModel(*second.atlas), EqualsAtlas(saved)) << location;
    second.atlas->CreateNewMap();
    EXPECT_EQ(second.atlas->GetCurrentMap()->GetId(), 1U);
    second.atlas->ChangeMap(second.atlas->GetAllMaps().front());
    second.atlas->GetAllMapPoints().front()->SetWorldPos({1, 2, 3});
    second.atlas->Save(location, {.overwrite = true});
    EXPECT_EQ(Atlas::Load(location).atlas->GetAllMaps().front()->GetAllMapPoints().front()->GetWorldPos(),
              Eigen::Vector3f(1, 2, 3));
  }
  EXPECT_THROW(static_cast<void>(Atlas::Load(folder / "none.osa")), Error);
}

TEST(Atlas, RefusesToSaveInsideAChange) {
  World world;
  const Change change(world.atlas.gate());
  EXPECT_THROW(static_cast<void>(ToModel(world.atlas)), Error);
}

}  // namespace
}  // namespace slamdb::live
