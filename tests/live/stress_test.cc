// SPDX-License-Identifier: BSD-3-Clause
// Threads like those of a SLAM system on one atlas, with saves beside them. Short; the thread sanitizer looks for
// races, a rank violation would deadlock, and each save is held against the rules of a sound atlas.
#include <atomic>
#include <filesystem>
#include <list>
#include <random>
#include <thread>

#include "slamdb/live/bridge.h"
#include "slamdb/live/checkpointer.h"
#include "slamdb/live/culling.h"
#include "tests/live/world.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::live {
namespace {

class Session {
 public:
  Session() {
    for (int i = 0; i < 6; ++i) AddKeyFrame();
  }

  void Track() {  // makes keyframes of frames, and reads what it tracks against
    std::mt19937 random(1);
    for (int i = 0; i < 40; ++i) {
      AddKeyFrame();
      Frame frame = world.MakeFrame({0, 0, 0});
      for (MapPoint* point : world.map()->GetAllMapPoints()) {
        if (point->isBad() || !frame.isInFrustum(point, 0.5F)) continue;
        point->IncreaseVisible();
        if (random() % 4 != 0) point->IncreaseFound();
        frame.mvpMapPoints[random() % World::kFeatures] = point;
      }
      for (KeyFrame* keyframe : world.map()->GetAllKeyFrames()) keyframe->GetPose();
    }
  }

  void BuildMap() {  // observes, moves and culls
    std::mt19937 random(2);
    std::list<MapPoint*> recent;
    for (int i = 0; i < 120; ++i) {
      const std::vector<KeyFrame*> keyframes = world.map()->GetAllKeyFrames();
      KeyFrame* latest = keyframes.back();
      {
        const Change change(world.atlas.gate());
        MapPoint* point = world.AddPoint(latest, {0.1F, 0.1F, 3});
        for (int k = 0; k < 4; ++k) Observe(point, keyframes[random() % keyframes.size()], random());
        point->ComputeDistinctiveDescriptors();
        point->UpdateNormalAndDepth();
        recent.push_back(point);
      }
      latest->UpdateConnections();
      {
        const Change change(world.atlas.gate());
        const std::lock_guard<std::mutex> lock(world.map()->mMutexMapUpdate);
        for (MapPoint* point : latest->GetMapPoints()) point->SetWorldPos(point->GetWorldPos() * 1.001F);
        latest->SetPose(latest->GetPose());
      }
      CullMapPoints(recent, latest->mnId, true);
      if (i % 10 == 9) CullKeyFrames(*latest, {.monocular = true});
    }
  }

  void CloseLoops() {  // fuses points, adds edges, moves the map
    std::mt19937 random(3);
    for (int i = 0; i < 60; ++i) {
      const std::vector<MapPoint*> points = world.map()->GetAllMapPoints();
      const std::vector<KeyFrame*> keyframes = world.map()->GetAllKeyFrames();
      if (points.size() > 2) points[random() % points.size()]->Replace(points[random() % points.size()]);
      KeyFrame *a = keyframes[random() % keyframes.size()], *b = keyframes[random() % keyframes.size()];
      for (KeyFrame* covisible : a->GetVectorCovisibleKeyFrames()) covisible->GetWeight(a);
      if (a != b && i % 20 == 0) {
        const Change change(world.atlas.gate());
        a->AddLoopEdge(b);
        b->AddLoopEdge(a);
      }
      if (i % 15 == 0) world.map()->ApplyScaledRotation({}, 1.001F);
      a->SetNotErase();
      a->SetErase();
    }
  }

  World world;

 private:
  void AddKeyFrame() {
    const Change change(world.atlas.gate());
    KeyFrame* before = last_;
    last_ = world.AddKeyFrame({0.01F * static_cast<float>(count_++), 0, 0});
    if (before == nullptr) return;
    last_->ChangeParent(before->isBad() ? world.map()->GetOriginKF() : before);
    last_->SetFirstConnection(false);
  }

  static void Observe(MapPoint* point, KeyFrame* keyframe, std::uint64_t number) {
    const int row = static_cast<int>(number % World::kFeatures);
    if (keyframe->isBad() || point->isBad() || point->IsInKeyFrame(keyframe)) return;
    if (MapPoint* taken = keyframe->GetMapPoint(static_cast<std::size_t>(row)); taken != nullptr)
      taken->EraseObservation(keyframe);
    World::Observe(point, keyframe, row);
  }

  KeyFrame* last_ = nullptr;
  int count_ = 0;
};

TEST(Live, StaysWholeUnderManyThreads) {
  const TemporaryFolder folder;
  const std::string store = folder / "maps.db";
  Session session;
  {
    Checkpointer checkpointer(session.world.atlas, store + "#run", {.interval = 0.01, .sync = false});
    std::atomic<int> running = 3;
    std::vector<std::thread> threads;
    for (void (Session::*work)() : {&Session::Track, &Session::BuildMap, &Session::CloseLoops})
      threads.emplace_back([&, work] {
        (session.*work)();
        --running;
      });
    while (running > 0) (void)ToModel(session.world.atlas, 1);
    for (std::thread& thread : threads) thread.join();
    checkpointer.Save();
    EXPECT_EQ(checkpointer.LastFailure(), std::nullopt);
    EXPECT_GT(checkpointer.LastSave().number, 1U);
  }
  const slamdb::Atlas model = ToModel(session.world.atlas);
  EXPECT_THAT(Store::Open(store).Load("run"), EqualsAtlas(model));
  EXPECT_GT(model.maps[0].keyframes.size(), 6U);
  const PostLoadReport report = FromModel(model).report;
  EXPECT_EQ(report.dangling(), report[LinkKind::kReference]) << report.ToString();
}

}  // namespace
}  // namespace slamdb::live
