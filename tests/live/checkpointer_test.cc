// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/checkpointer.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <thread>

#include "slamdb/base/error.h"
#include "slamdb/live/bridge.h"
#include "slamdb/model/index.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/live/world.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::live {
namespace {

class CheckpointerTest : public ::testing::Test {
 protected:
  slamdb::Atlas Stored() const { return Store::Open(path()).Load("run"); }
  std::string path() const { return folder_ / "maps.db"; }
  std::string location() const { return path() + "#run"; }

  const CheckpointOptions by_hand_{.interval = 0, .sync = false};

 private:
  const TemporaryFolder folder_;
};

TEST_F(CheckpointerTest, SavesAllAndThenWhatChanged) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.keyframes = 10, .points = 300, .features = 300}));
  Checkpointer checkpointer(*live.atlas, location(), by_hand_);
  EXPECT_EQ(checkpointer.LastSave().keyframes, 10U);
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(*live.atlas)));
  EXPECT_EQ(checkpointer.Save().points, 0U) << "nothing changed";

  Map* map = live.atlas->GetAllMaps().front();
  map->GetAllMapPoints()[5]->SetWorldPos({1, 2, 3});
  map->GetAllKeyFrames()[2]->SetPose({});
  const CheckpointReport report = checkpointer.Save();
  EXPECT_EQ(report.points, 1U);
  EXPECT_EQ(report.keyframes, 1U);
  EXPECT_EQ(report.number, 3U);
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(*live.atlas)));
  for (const TableChanges& changes : report.saved.tables) {
    const bool is_list = changes.table == "map_point" || changes.table == "keyframe";
    EXPECT_TRUE(!is_list || changes.updated == 1) << changes.table << ": " << changes.updated;
  }
}

TEST_F(CheckpointerTest, SeesPublicMembersThatClientsWrite) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  Checkpointer checkpointer(world.atlas, location(), by_hand_);
  a->mNextKF = b;
  b->mPrevKF = a;
  b->mfScale = 2;
  EXPECT_EQ(checkpointer.Save().keyframes, 2U);
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(world.atlas)));
}

TEST_F(CheckpointerTest, FollowsWhatHappensToMaps) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 5; ++i) keyframes.push_back(world.AddKeyFrame());
  std::vector<MapPoint*> points = world.Share(keyframes, 20, 0);
  for (KeyFrame* keyframe : keyframes) keyframe->UpdateConnections();
  Checkpointer checkpointer(world.atlas, location(), by_hand_);
  const auto save_and_compare = [&](const char* what) {
    checkpointer.Save();
    EXPECT_THAT(Stored(), EqualsAtlas(ToModel(world.atlas))) << what;
  };
  keyframes[4]->mPrevKF = keyframes[3];
  keyframes[3]->SetBadFlag();
  save_and_compare("a keyframe went, though another still points to it");
  keyframes[1]->AddMapPoint(points[7], 30);  // one side only
  points[7]->SetBadFlag();
  save_and_compare("a point went, though a slot still points to it");
  world.map()->EraseMapPoint(points[2]);
  save_and_compare("erased");
  world.map()->AddMapPoint(points[2]);
  save_and_compare("added again, now last");
  Map* before = world.map();
  world.atlas.CreateNewMap();
  save_and_compare("an empty map");
  world.AddPoint(world.AddKeyFrame());
  save_and_compare("a second map");
  for (KeyFrame* keyframe : before->GetAllKeyFrames()) {
    keyframe->UpdateMap(world.map());
    world.map()->AddKeyFrame(keyframe);
    before->EraseKeyFrame(keyframe);
  }
  save_and_compare("keyframes moved to it without their points");
  for (MapPoint* point : before->GetAllMapPoints()) {
    point->UpdateMap(world.map());
    world.map()->AddMapPoint(point);
  }
  save_and_compare("points too");
  world.atlas.SetMapBad(before);
  world.atlas.RemoveBadMaps();
  save_and_compare("the emptied map is gone");
  world.map()->ChangeId(7);
  world.map()->InformNewBigChange();
  save_and_compare("numbers of the map");
}

// ORB-SLAM3 lists a keyframe after its points know of it, and a save may come in between.
TEST_F(CheckpointerTest, LinksThatWereThereFirstAreSavedOnceTheirTargetsAre) {
  World world;
  KeyFrame* first = world.AddKeyFrame();
  const std::vector<MapPoint*> points = world.Share({first}, 20, 0);
  Checkpointer checkpointer(world.atlas, location(), by_hand_);
  Frame frame = world.MakeFrame({1, 0, 0});
  auto* late = new KeyFrame(frame, world.map());
  for (int row = 0; row < 20; ++row) World::Observe(points[static_cast<std::size_t>(row)], late, row);
  late->UpdateConnections();
  auto* late_point = new MapPoint({0, 0, 4}, first, world.map());
  World::Observe(late_point, first, 30);
  first->mNextKF = late;
  checkpointer.Save();
  EXPECT_EQ(Stored().maps[0].points[3].observations.size(), 1U) << "the keyframe is in no map";
  world.map()->AddKeyFrame(late);
  world.map()->AddMapPoint(late_point);
  checkpointer.Save();
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(world.atlas)));
  EXPECT_EQ(Stored().maps[0].points[3].observations.size(), 2U);
  EXPECT_EQ(Stored().maps[0].keyframes[0].connections.size(), 1U);
  EXPECT_EQ(Stored().maps[0].keyframes[0].features.map_points[30].value(), late_point->mnId);
  EXPECT_EQ(checkpointer.Save().points, 0U) << "and that is all";
}

// Merging flags a map bad first and moves what is in it later.
TEST_F(CheckpointerTest, KeepsABadMapUntilItIsRemoved) {
  World world;
  std::vector<KeyFrame*> keyframes;
  for (int i = 0; i < 4; ++i) keyframes.push_back(world.AddKeyFrame());
  Map* before = world.map();
  world.atlas.CreateNewMap();
  world.AddKeyFrame();
  Checkpointer checkpointer(world.atlas, location(), by_hand_);
  world.map()->AddKeyFrame(keyframes[0]);
  world.atlas.SetMapBad(before);
  checkpointer.Save();
  EXPECT_EQ(Stored().maps.size(), 2U);
  EXPECT_EQ(Stored().maps[1].keyframes.size(), 3U);
  for (std::size_t i = 1; i < keyframes.size(); ++i) world.map()->AddKeyFrame(keyframes[i]);
  world.atlas.RemoveBadMaps();
  checkpointer.Save();
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(world.atlas)));
  EXPECT_EQ(Stored().maps.size(), 1U);
}

TEST_F(CheckpointerTest, LeavesBadEntriesAsTheyWereRecorded) {
  slamdb::Atlas model = SynthesizeAtlas({.keyframes = 10, .points = 300, .features = 300});
  slamdb::MapPoint& bad = model.maps[0].points[7];
  const KeyFrameId goes = bad.observations.back().keyframe;
  bad.bad = true;
  const LiveAtlas live = FromModel(model);
  Checkpointer checkpointer(*live.atlas, location(), by_hand_);
  for (KeyFrame* keyframe : live.atlas->GetAllMaps().front()->GetAllKeyFrames())
    if (keyframe->mnId == goes.value()) keyframe->SetBadFlag();
  checkpointer.Save();
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(*live.atlas)));
  const slamdb::Atlas stored = Stored();
  EXPECT_EQ(AtlasIndex(stored).FindPoint(0, bad.id)->observations, bad.observations);
}

TEST_F(CheckpointerTest, RefusesWhatIsNoStoreAndNoInterval) {
  World world;
  EXPECT_THROW(Checkpointer(world.atlas, path() + ".osa#run", by_hand_), Error);
  for (const double interval : {-1.0, 1e300, std::nan("")})
    EXPECT_THROW(Checkpointer(world.atlas, location(), {.interval = interval}), Error);
}

// Random calls, and a comparison with the whole copy after each batch.
TEST_F(CheckpointerTest, EqualsTheWholeAtlasAfterAnyChanges) {
  const LiveAtlas live =
      FromModel(SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 15, .points = 400, .features = 300}));
  Map* map = live.atlas->GetAllMaps().front();
  Checkpointer checkpointer(*live.atlas, location(), by_hand_);
  std::mt19937 random(1);
  const auto any = [&](const auto& list) { return list[random() % list.size()]; };
  for (int batch = 0; batch < 8; ++batch) {
    for (int i = 0; i < 12; ++i) {
      KeyFrame* keyframe = any(map->GetAllKeyFrames());
      MapPoint *point = any(map->GetAllMapPoints()), *other = any(map->GetAllMapPoints());
      switch (random() % 7) {
        case 0:
          point->SetBadFlag();
          break;
        case 1:
          point->Replace(other);
          break;
        case 2:
          keyframe->UpdateConnections();
          break;
        case 3:
          point->UpdateNormalAndDepth();
          break;
        case 4:
          point->EraseObservation(keyframe);
          break;
        case 5:
          point = new MapPoint({1, 1, 1}, keyframe, map);
          map->AddMapPoint(point);
          World::Observe(point, keyframe, 3);
          break;
        case 6:
          if (i == 0) keyframe->SetBadFlag();
          break;
      }
    }
    checkpointer.Save();
    ASSERT_THAT(Stored(), EqualsAtlas(ToModel(*live.atlas))) << batch;
  }
}

TEST_F(CheckpointerTest, SavesByItself) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.keyframes = 6, .points = 100, .features = 150}));
  const Checkpointer checkpointer(*live.atlas, location(), {.interval = 0.02, .sync = false});
  MapPoint* point = live.atlas->GetAllMaps().front()->GetAllMapPoints().front();
  point->SetWorldPos({4, 5, 6});
  const std::uint64_t now = checkpointer.LastSave().number;
  while (checkpointer.LastSave().number < now + 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(Stored().maps[0].points[0].position, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(checkpointer.LastFailure(), std::nullopt);
}

TEST_F(CheckpointerTest, CatchesUpAfterAFailure) {
  const LiveAtlas live = FromModel(SynthesizeAtlas({.keyframes = 6, .points = 100, .features = 150}));
  Checkpointer checkpointer(*live.atlas, location(), by_hand_);
  MapPoint* point = live.atlas->GetAllMaps().front()->GetAllMapPoints().front();
  point->SetWorldPos({4, 5, 6});
  const std::filesystem::path elsewhere = path() + ".moved";
  std::filesystem::rename(path(), elsewhere);
  std::filesystem::create_directory(path());
  EXPECT_THROW(checkpointer.Save(), Error);
  std::filesystem::remove(path());
  std::filesystem::rename(elsewhere, path());
  checkpointer.Save();
  EXPECT_THAT(Stored(), EqualsAtlas(ToModel(*live.atlas)));
}

TEST_F(CheckpointerTest, IsTheOnlyOne) {
  World world;
  world.AddKeyFrame();
  {
    const Checkpointer checkpointer(world.atlas, location(), by_hand_);
    EXPECT_THROW(Checkpointer(world.atlas, location(), by_hand_), Error);
  }
  EXPECT_THROW(Checkpointer(world.atlas, path(), by_hand_), Error) << "no name";
  const Checkpointer again(world.atlas, location(), by_hand_);
}

}  // namespace
}  // namespace slamdb::live
