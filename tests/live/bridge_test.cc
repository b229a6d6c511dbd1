// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/bridge.h"

#include <gmock/gmock.h>

#include "slamdb/checks/check.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/live/kinds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::live {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Bridge, BringsAnAtlasToLifeAndBack) {
  for (const SyntheticOptions& kind : Kinds()) {
    const slamdb::Atlas model = SynthesizeAtlas(kind);
    const LiveAtlas live = FromModel(model);
    EXPECT_TRUE(live.report.whole()) << live.report.ToString();
    EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model));
    EXPECT_THAT(ToModel(*FromModel(model, 1).atlas, 1), EqualsAtlas(model)) << "one thread";
  }
}

class RealAtlas : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Bridge, RealAtlas, ::testing::ValuesIn(kRealAtlases));

TEST_P(RealAtlas, ComesBackByteForByte) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  LiveAtlas live = FromModel(ReadOrbslam3(path, {}, notices));
  RecordProperty("report", live.report.ToString());
  const std::string bytes = EncodeOrbslam3(ToModel(*live.atlas));
  EXPECT_TRUE(bytes == ReadWhole(path)) << "not the bytes of the file";
}

TEST_P(RealAtlas, CountsObservationsAsRecorded) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const slamdb::Atlas model = ReadOrbslam3(path, {}, notices);
  const LiveAtlas live = FromModel(model);
  const std::vector<Map*> maps = live.atlas->GetAllMaps();
  ASSERT_THAT(maps, SizeIs(model.maps.size()));
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::vector<MapPoint*> points = maps[i]->GetAllMapPoints();
    ASSERT_THAT(points, SizeIs(model.maps[i].points.size()));
    for (std::size_t row = 0; row < points.size(); ++row)
      ASSERT_EQ(points[row]->Observations(), model.maps[i].points[row].observation_count);
  }
}

TEST(Bridge, ResolvesEveryKindOfLink) {
  const slamdb::Atlas model =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 8, .points = 300});
  const LiveAtlas live = FromModel(model);
  Map* map = live.atlas->GetAllMaps().front();
  const std::vector<KeyFrame*> keyframes = map->GetAllKeyFrames();
  const AtlasIndex index(model);
  for (std::size_t row = 0; row < keyframes.size(); ++row) {
    const slamdb::KeyFrame& record = model.maps[0].keyframes[row];
    KeyFrame& keyframe = *keyframes[row];
    const auto object = [&](KeyFrameId id) { return id ? keyframes[index.KeyFrameRow(0, id)] : nullptr; };
    EXPECT_EQ(keyframe.GetParent(), object(record.parent));
    EXPECT_EQ(keyframe.mPrevKF, object(record.previous));
    EXPECT_EQ(keyframe.mNextKF, object(record.next));
    EXPECT_THAT(keyframe.GetChilds(), SizeIs(record.children.size()));
    EXPECT_THAT(keyframe.GetConnectedKeyFrames(), SizeIs(record.connections.size()));
    for (const Connection& connection : record.connections)
      EXPECT_EQ(keyframe.GetWeight(object(connection.keyframe)), connection.weight);
    ASSERT_NE(keyframe.mpCamera, nullptr);
    EXPECT_EQ(keyframe.mpCamera2, nullptr);
    EXPECT_EQ(keyframe.GetMap(), map);
    const std::vector<MapPoint*> slots = keyframe.GetMapPointMatches();
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      EXPECT_EQ(slots[slot] == nullptr ? MapPointId() : MapPointId(slots[slot]->mnId),
                record.features.map_points[slot]);
  }
  EXPECT_EQ(map->GetOriginKF(), keyframes.front());
}

// Lists of loaded points stand side by side in a block.
TEST(Bridge, ListsThatGrowLeaveTheirNeighboursAlone) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 12, .points = 260}));
  Map* map = live.atlas->GetAllMaps().front();
  const std::vector<MapPoint*> points = map->GetAllMapPoints();
  const std::vector<KeyFrame*> keyframes = map->GetAllKeyFrames();
  std::vector<std::map<KeyFrame*, std::tuple<int, int>>> expected;
  for (MapPoint* point : points) expected.push_back(point->GetObservations());
  for (std::size_t row = 0; row < points.size(); row += 2) {
    for (KeyFrame* keyframe : keyframes) {
      if (points[row]->IsInKeyFrame(keyframe)) continue;
      points[row]->AddObservation(keyframe, 7);
      expected[row][keyframe] = {7, -1};
    }
    points[row]->EraseObservation(keyframes[row % keyframes.size()]);
    expected[row].erase(keyframes[row % keyframes.size()]);
  }
  for (std::size_t row = 0; row < points.size(); ++row) EXPECT_EQ(points[row]->GetObservations(), expected[row]);
  live.atlas->clearAtlas();
}

TEST(Bridge, ReportsWhatDanglesAndLoadsTheRest) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 8, .points = 300});
  slamdb::Map& map = model.maps[0];
  const KeyFrameId nowhere(1'000'000);
  map.points[3].observations.back().keyframe = nowhere;
  map.points[4].reference = nowhere;
  map.points[5].replaced_by = MapPointId(1'000'000);
  map.keyframes[2].features.map_points[0] = MapPointId(1'000'000);
  map.keyframes[2].connections.push_back({nowhere, 3});
  map.keyframes[3].children.push_back(nowhere);
  map.keyframes[4].parent = nowhere;
  map.keyframes[5].loop_edges.push_back(nowhere);
  map.keyframes[5].merge_edges.push_back(nowhere);
  map.keyframes[6].next = nowhere;
  map.keyframes[6].camera = CameraId(77);
  map.origins.push_back(nowhere);
  const LiveAtlas live = FromModel(model);
  for (const LinkKind kind : {LinkKind::kObservation, LinkKind::kReference, LinkKind::kReplacement, LinkKind::kSlot,
                              LinkKind::kConnection, LinkKind::kChild, LinkKind::kParent, LinkKind::kLoopEdge,
                              LinkKind::kMergeEdge, LinkKind::kNext, LinkKind::kCamera, LinkKind::kOrigin})
    EXPECT_EQ(live.report[kind], 1U) << ToString(kind);
  EXPECT_EQ(live.report.dangling(), 12U);
  EXPECT_THAT(live.report.examples,
              ::testing::Contains(DanglingLink{LinkKind::kReference, map.id, {}, map.points[4].id, nowhere.value()}));
  EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model)) << "what dangles is written as it was";

  const std::vector<KeyFrame*> keyframes = live.atlas->GetAllMaps()[0]->GetAllKeyFrames();
  EXPECT_EQ(keyframes[4]->GetParent(), nullptr);
  EXPECT_EQ(keyframes[6]->mpCamera, nullptr);
  for (KeyFrame* child : keyframes[3]->GetChilds()) EXPECT_NE(child, nullptr);
}

TEST(Bridge, KeepsBadAndDuplicateEntries) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 8, .points = 300});
  model.maps[0].points[7].bad = true;
  model.maps[0].keyframes[5].bad.recorded = 205;  // not a bool: ORB-SLAM3 wrote uninitialised memory
  model.maps[0].points[9].id = model.maps[0].points[8].id;
  const LiveAtlas live = FromModel(model);
  EXPECT_EQ(live.report.bad_points, 1U);
  EXPECT_EQ(live.report.bad_keyframes, 1U);
  EXPECT_EQ(live.report.duplicate_ids, 1U);
  Map* map = live.atlas->GetAllMaps()[0];
  EXPECT_TRUE(map->GetAllMapPoints()[7]->isBad());
  EXPECT_THAT(map->GetAllMapPoints()[7]->GetObservations(), IsEmpty());
  EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(model));
}

TEST(Bridge, GivesIdsAboveThoseInUse) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 8, .points = 300});
  model.next_ids.map_point = 5;  // too low, as in a damaged file
  const LiveAtlas live = FromModel(model);
  EXPECT_EQ(ToModel(*live.atlas).next_ids.map_point, 5U) << "as long as nothing is made";
  Map* map = live.atlas->GetAllMaps()[0];
  MapPoint point(Eigen::Vector3f::Zero(), map->GetAllKeyFrames()[0], map);
  std::uint64_t highest = 0;
  for (const slamdb::MapPoint& other : model.maps[0].points) highest = std::max(highest, other.id.value());
  EXPECT_EQ(point.mnId, highest + 1);
}

// Links to what is missing lead nowhere, not to the next object that is made.
TEST(Bridge, GivesNoIdThatDangles) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 8, .points = 300});
  model.maps[0].keyframes[2].features.map_points[0] = MapPointId(70'000);
  model.maps[0].keyframes[3].children.push_back(KeyFrameId(80'000));
  model.maps[0].keyframes[4].children.push_back(KeyFrameId(std::uint64_t{1} << 60));
  model.next_ids = {};
  const LiveAtlas live = FromModel(model);
  Map* map = live.atlas->GetAllMaps()[0];
  EXPECT_EQ(MapPoint(Eigen::Vector3f::Zero(), map->GetAllKeyFrames()[0], map).mnId, 70'001U);
  EXPECT_EQ(live.report.keyframe_floor, 80'001U);
}

TEST(Bridge, ANewObservationTakesThePlaceOfOneThatDangled) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 8, .points = 300});
  slamdb::MapPoint& record = model.maps[0].points[3];
  record.observations.back().left = 99'999;
  const LiveAtlas live = FromModel(model);
  Map* map = live.atlas->GetAllMaps()[0];
  EXPECT_EQ(live.report[LinkKind::kObservation], 1U);
  for (KeyFrame* keyframe : map->GetAllKeyFrames())
    if (keyframe->mnId == record.observations.back().keyframe.value())
      map->GetAllMapPoints()[3]->AddObservation(keyframe, 5);
  const slamdb::MapPoint saved = ToModel(*live.atlas).maps[0].points[3];
  ASSERT_EQ(saved.observations.size(), record.observations.size());
  EXPECT_EQ(saved.observations.back().left, 5);
}

TEST(Bridge, LeavesOutWhatIsNotInTheMap) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.keyframes = 10, .points = 300}));
  Map* map = live.atlas->GetAllMaps()[0];
  map->GetAllKeyFrames()[4]->SetBadFlag();
  map->GetAllMapPoints()[11]->SetBadFlag();
  live.atlas->CreateNewMap();  // nothing in it
  const slamdb::Atlas model = ToModel(*live.atlas);
  ASSERT_THAT(model.maps, SizeIs(1));
  EXPECT_THAT(model.maps[0].keyframes, SizeIs(9));
  const CheckReport report = CheckAtlas(model, {});
  for (const RuleResult& result : report.results)
    EXPECT_NE(result.severity, Severity::kError) << result.id << ": " << result.findings.front().message;
}

TEST(Bridge, KeepsLandmarks) {
  slamdb::Atlas atlas = SynthesizeAtlas({.keyframes = 10, .points = 300});
  Landmark landmark;
  landmark.mean = {1, 0, 4};
  landmark.cov_11 = 2;
  landmark.cov_22 = 1;
  atlas.maps[0].landmarks = {landmark};
  LiveAtlas live = FromModel(atlas);
  EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(atlas));
  Map* map = live.atlas->GetAllMaps()[0];
  map->ApplyScaledRotation(
      {Quaternionf(Eigen::AngleAxisf(static_cast<float>(M_PI) / 2, Eigen::Vector3f::UnitZ())), {0, 0, 10}}, 2, false);
  for (KeyFrame* keyframe : map->GetAllKeyFrames()) map->EraseKeyFrame(keyframe);
  for (MapPoint* point : map->GetAllMapPoints()) map->EraseMapPoint(point);
  const slamdb::Atlas landmarks_alone = ToModel(*live.atlas);
  ASSERT_THAT(landmarks_alone.maps, SizeIs(1));
  ASSERT_THAT(landmarks_alone.maps[0].landmarks, SizeIs(1));
  const Landmark& moved = landmarks_alone.maps[0].landmarks[0];
  EXPECT_LT((moved.mean - Eigen::Vector3d(0, 2, 18)).norm(), 1e-5);
  EXPECT_NEAR(moved.cov_22, 8, 1e-5);
  map->clear();
  EXPECT_THAT(ToModel(*live.atlas).maps, IsEmpty());
}

}  // namespace
}  // namespace slamdb::live
