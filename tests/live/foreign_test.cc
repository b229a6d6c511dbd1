// SPDX-License-Identifier: BSD-3-Clause
// What public methods answer to null pointers and to objects of another atlas: questions "no", links an error.
#include <functional>
#include <list>

#include "slamdb/live/bridge.h"
#include "slamdb/live/culling.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// An atlas with two keyframes and two points, and an object of each kind of another atlas, all of the same ids.
class Foreign : public ::testing::Test {
 protected:
  Foreign() {
    World::Observe(point, keyframe, 3);
    World::Observe(foreign_point, foreign_keyframe, 3);
    keyframe->AddConnection(second, 15);
    keyframe->AddChild(second);
  }

  void Refuses(const std::function<void(KeyFrame*)>& work) {
    EXPECT_EQ(KindOf([&] { work(nullptr); }), ErrorKind::kUsage) << "null";
    EXPECT_EQ(KindOf([&] { work(foreign_keyframe); }), ErrorKind::kUsage) << "foreign";
  }
  void RefusesPoint(const std::function<void(MapPoint*)>& work) {
    EXPECT_EQ(KindOf([&] { work(nullptr); }), ErrorKind::kUsage) << "null";
    EXPECT_EQ(KindOf([&] { work(foreign_point); }), ErrorKind::kUsage) << "foreign";
  }

  World world, other;
  Map* map = world.map();
  KeyFrame *keyframe = world.AddKeyFrame(), *second = world.AddKeyFrame();
  KeyFrame *foreign_keyframe = other.AddKeyFrame(), *foreign_second = other.AddKeyFrame();
  MapPoint *point = world.AddPoint(keyframe), *second_point = world.AddPoint(keyframe);
  MapPoint* foreign_point = other.AddPoint(foreign_keyframe);
  Frame frame = world.MakeFrame({0, 0, 0}), foreign_frame = other.MakeFrame({0, 0, 0});
};

TEST_F(Foreign, PointsAreMadeOfWhatIsTheirs) {
  Refuses([&](KeyFrame* reference) { MapPoint made({0, 0, 0}, reference, map); });
  Refuses([&](KeyFrame* host) { MapPoint made(0.5, {1, 1}, keyframe, host, map); });
  EXPECT_EQ(KindOf([&] { MapPoint made({0, 0, 0}, keyframe, nullptr); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { MapPoint made({0, 0, 0}, nullptr, &frame, 0); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { MapPoint made({0, 0, 0}, map, nullptr, 0); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { MapPoint made({0, 0, 0}, map, &foreign_frame, 0); }), ErrorKind::kUsage);
  const MapPoint made({0, 0, 1}, map, &frame, -5);
  EXPECT_EQ(made.mnFirstKFid, -1) << "no such keypoint: no descriptor and no range";
}

TEST_F(Foreign, PointsAnswer) {
  for (KeyFrame* stranger : {static_cast<KeyFrame*>(nullptr), foreign_keyframe}) {
    EXPECT_FALSE(point->IsInKeyFrame(stranger));
    EXPECT_EQ(point->GetIndexInKeyFrame(stranger), std::make_tuple(-1, -1));
    point->EraseObservation(stranger);
  }
  EXPECT_EQ(point->Observations(), 1);
  Refuses([&](KeyFrame* stranger) { point->AddObservation(stranger, 0); });
  Refuses([&](KeyFrame* stranger) { point->PredictScale(1, stranger); });
  RefusesPoint([&](MapPoint* stranger) { point->Replace(stranger); });
  EXPECT_FALSE(point->isBad());
  EXPECT_EQ(KindOf([&] { point->PredictScale(1, static_cast<Frame*>(nullptr)); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { point->PredictScale(1, &foreign_frame); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { point->UpdateMap(other.map()); }), ErrorKind::kUsage);
  EXPECT_EQ(point->GetMap(), map);
  point->UpdateMap(nullptr);
  EXPECT_EQ(point->GetMap(), nullptr);
  point->SetBadFlag();
}

TEST_F(Foreign, PointsPreSaveAndPostLoad) {
  std::set<KeyFrame*> keyframes = {nullptr, foreign_keyframe};
  std::set<MapPoint*> points = {nullptr, foreign_point};
  MapPoint without_reference({0, 0, 1}, map, &frame, 0);
  without_reference.PreSave(keyframes, points);
  EXPECT_EQ(without_reference.mBackupRefKFId, KeyFrameId::kNone);
  EXPECT_EQ(without_reference.mBackupReplacedId, -1);
  EXPECT_FALSE(without_reference.mBackupReplacedId >= 0) << "as ORB-SLAM3 asks";
  point->PreSave(keyframes, points);
  EXPECT_THAT(point->mBackupObservationsId1, IsEmpty());
  point->mBackupObservationsId1 = {{0, 1}, {1, 2}};
  point->mBackupReplacedId = 0;
  std::map<long unsigned int, KeyFrame*> keyframe_by_id = {{0, foreign_keyframe}, {1, nullptr}};
  std::map<long unsigned int, MapPoint*> point_by_id = {{0, foreign_point}};
  const PostLoadReport report = point->PostLoad(keyframe_by_id, point_by_id);
  EXPECT_EQ(report[LinkKind::kObservation], 2U);
  EXPECT_EQ(report[LinkKind::kReplacement], 1U);
  EXPECT_EQ(point->GetReplaced(), nullptr);
}

TEST_F(Foreign, KeyFramesAreMadeOfWhatIsTheirs) {
  EXPECT_EQ(KindOf([&] { KeyFrame made(frame, nullptr); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { KeyFrame made(foreign_frame, map); }), ErrorKind::kUsage);
  frame.mvpMapPoints[7] = foreign_point;
  EXPECT_EQ(KindOf([&] { KeyFrame made(frame, map); }), ErrorKind::kUsage);
}

TEST_F(Foreign, KeyFramesAnswer) {
  for (KeyFrame* stranger : {static_cast<KeyFrame*>(nullptr), foreign_keyframe, foreign_second}) {
    EXPECT_EQ(keyframe->GetWeight(stranger), 0);
    EXPECT_FALSE(keyframe->hasChild(stranger));
    keyframe->EraseConnection(stranger);
    keyframe->EraseChild(stranger);
  }
  EXPECT_EQ(keyframe->GetWeight(second), 15);
  for (MapPoint* stranger : {static_cast<MapPoint*>(nullptr), foreign_point}) keyframe->EraseMapPointMatch(stranger);
  EXPECT_EQ(keyframe->GetMapPoint(3), point);
  EXPECT_EQ(keyframe->GetMapPoint(1000), nullptr);
}

TEST_F(Foreign, KeyFramesRefuseLinks) {
  Refuses([&](KeyFrame* stranger) { keyframe->AddConnection(stranger, 20); });
  Refuses([&](KeyFrame* stranger) { keyframe->AddChild(stranger); });
  Refuses([&](KeyFrame* stranger) { keyframe->AddLoopEdge(stranger); });
  Refuses([&](KeyFrame* stranger) { keyframe->AddMergeEdge(stranger); });
  EXPECT_EQ(KindOf([&] { keyframe->ChangeParent(foreign_keyframe); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { keyframe->ChangeParent(keyframe); }), ErrorKind::kUsage);
  keyframe->ChangeParent(nullptr);
  EXPECT_EQ(KindOf([&] { keyframe->AddMapPoint(foreign_point, 1); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { keyframe->ReplaceMapPointMatch(1, foreign_point); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { keyframe->EraseMapPointMatch(-1); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { keyframe->UpdateMap(other.map()); }), ErrorKind::kUsage);
  cv::Point2f place;
  float u = 0, v = 0;
  RefusesPoint([&](MapPoint* stranger) { keyframe->ProjectPointDistort(stranger, place, u, v); });
  RefusesPoint([&](MapPoint* stranger) { keyframe->ProjectPointUnDistort(stranger, place, u, v); });
  EXPECT_THAT(keyframe->GetLoopEdges(), IsEmpty());
  keyframe->AddMapPoint(nullptr, 3);
  EXPECT_EQ(keyframe->GetMapPoint(3), nullptr) << "null clears the slot";
}

TEST_F(Foreign, FramesWantTheirCamerasAndPoints) {
  EXPECT_EQ(KindOf([&] { Frame made(world.atlas, world.Image(), nullptr); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Frame made(world.atlas, world.Image(), other.left); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Frame made(world.atlas, world.Image(), world.left, other.left); }), ErrorKind::kUsage);
  RefusesPoint([&](MapPoint* stranger) { frame.isInFrustum(stranger, 0.5F); });
  Eigen::Vector3f position;
  EXPECT_FALSE(frame.UnprojectStereo(-1, position));
  EXPECT_FALSE(frame.UnprojectStereo(1000, position));
}

TEST_F(Foreign, MapsTakeWhatIsTheirs) {
  Refuses([&](KeyFrame* stranger) { map->AddKeyFrame(stranger); });
  RefusesPoint([&](MapPoint* stranger) { map->AddMapPoint(stranger); });
  map->EraseKeyFrame(nullptr);
  map->EraseKeyFrame(foreign_keyframe);
  map->EraseMapPoint(nullptr);
  map->EraseMapPoint(foreign_point);
  EXPECT_THAT(map->GetAllKeyFrames(), ElementsAre(keyframe, second));
  EXPECT_THAT(other.map()->GetAllMapPoints(), ElementsAre(foreign_point)) << "the other atlas keeps its own";
  map->SetReferenceMapPoints({nullptr, point});
  EXPECT_THAT(map->GetReferenceMapPoints(), SizeIs(2));
  map->mvpKeyFrameOrigins = {nullptr, keyframe, foreign_keyframe};
  EXPECT_THAT(ToModel(world.atlas).maps[0].origins, ElementsAre(KeyFrameId(keyframe->mnId)));
}

TEST_F(Foreign, AtlasesTakeWhatIsTheirs) {
  Refuses([&](KeyFrame* stranger) { world.atlas.AddKeyFrame(stranger); });
  RefusesPoint([&](MapPoint* stranger) { world.atlas.AddMapPoint(stranger); });
  MapPoint homeless({0, 0, 1}, keyframe, map);
  homeless.UpdateMap(nullptr);
  EXPECT_EQ(KindOf([&] { world.atlas.AddMapPoint(&homeless); }), ErrorKind::kUsage) << "of no map";
  for (Map* stranger : {static_cast<Map*>(nullptr), other.map()}) {
    EXPECT_EQ(KindOf([&] { world.atlas.ChangeMap(stranger); }), ErrorKind::kUsage);
    world.atlas.SetMapBad(stranger);
  }
  EXPECT_EQ(world.atlas.GetCurrentMap(), map);
  EXPECT_EQ(world.atlas.CountMaps(), 1);
  EXPECT_FALSE(other.map()->IsBad());
  world.atlas.SetMapBad(map);
  EXPECT_EQ(KindOf([&] { world.atlas.ChangeMap(map); }), ErrorKind::kUsage) << "a bad one";
}

TEST_F(Foreign, CamerasBelongToOneAtlas) {
  EXPECT_EQ(KindOf([&] { world.atlas.AddCamera(nullptr); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { world.atlas.AddCamera(other.left); }), ErrorKind::kUsage);
  EXPECT_EQ(world.atlas.AddCamera(world.left), world.left) << "its own, again";
  EXPECT_EQ(world.atlas.AddCamera(new GeometricCamera(*other.left)), world.left)
      << "a copy is of no atlas; an equal one";
  auto* fisheye = new KannalaBrandt8({1, 1, 1, 1, 0, 0, 0, 0});
  EXPECT_EQ(world.atlas.AddCamera(fisheye), fisheye);
  EXPECT_EQ(KindOf([&] { other.atlas.AddCamera(fisheye); }), ErrorKind::kUsage);
}

TEST_F(Foreign, CullingPassesOverNull) {
  std::list<MapPoint*> recent = {nullptr, point};
  EXPECT_EQ(CullMapPoints(recent, 0, true), 0);
  EXPECT_THAT(recent, ElementsAre(point));
}

}  // namespace
}  // namespace slamdb::live
