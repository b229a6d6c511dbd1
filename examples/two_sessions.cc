// SPDX-License-Identifier: BSD-3-Clause
// two_sessions FOLDER: a SLAM system that keeps its map in a store. Session one builds a map and saves it. Session two
// loads it, checks it, goes on with it while a checkpointer saves in the background, and is killed. Session three finds
// everything that had been saved. Tracking is made up: a synthetic world says which keyframe sees which point.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>

#include "slamdb/checks/check.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/live/atlas.h"
#include "slamdb/live/bridge.h"
#include "slamdb/live/checkpointer.h"
#include "slamdb/live/frame.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/synthetic/synthesize.h"

using namespace slamdb::live;  // NOLINT(google-build-using-namespace): the names of ORB-SLAM3

namespace {

constexpr std::size_t kFirstSession = 12;  // keyframes of the world that session one gets to see

void Expect(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
  std::printf("  %s\n", what);
}

// What tracking and local mapping do with each new image of the synthetic world.
class Mapper {
 public:
  explicit Mapper(Atlas& atlas) : atlas_(atlas), world_(slamdb::SynthesizeAtlas({.keyframes = 24, .points = 600})) {
    if (atlas.GetAllCameras().empty()) atlas.AddCamera(new GeometricCamera(world_.cameras.front()));
    atlas.SetVocabulary(world_.vocabulary);
    for (const slamdb::MapPoint& point : world_.maps[0].points) position_of_[point.id] = point.position;
    // A loaded map: recognise its points by their places.
    if (atlas.CountMaps() == 0) return;
    atlas.ChangeMap(atlas.GetAllMaps().back());
    for (MapPoint* point : atlas.GetAllMapPoints()) point_at_[Place(point->GetWorldPos())] = point;
  }

  // Makes a keyframe of the `number`th image: one Change, so that a save has all of it or nothing.
  KeyFrame* See(std::size_t number) {
    const slamdb::KeyFrame& image = world_.maps[0].keyframes[number];
    Map* map = atlas_.GetCurrentMap();
    Frame frame(atlas_, image, atlas_.GetAllCameras().front());
    const Change change(atlas_.gate());
    auto* keyframe = new KeyFrame(frame, map);
    map->AddKeyFrame(keyframe);
    for (std::size_t row = 0; row < image.features.map_points.size(); ++row) {
      if (!image.features.map_points[row]) continue;
      MapPoint* point = FindOrMake(position_of_.at(image.features.map_points[row]), keyframe);
      point->AddObservation(keyframe, static_cast<int>(row));
      keyframe->AddMapPoint(point, row);
      point->ComputeDistinctiveDescriptors();
      point->UpdateNormalAndDepth();
    }
    keyframe->UpdateConnections();
    if (map->mvpKeyFrameOrigins.empty()) map->mvpKeyFrameOrigins.push_back(keyframe);
    return keyframe;
  }

 private:
  using Coordinates = std::tuple<float, float, float>;
  static Coordinates Place(const Eigen::Vector3f& position) { return {position.x(), position.y(), position.z()}; }

  MapPoint* FindOrMake(const Eigen::Vector3f& position, KeyFrame* keyframe) {
    MapPoint*& point = point_at_[Place(position)];
    if (point == nullptr) {
      point = new MapPoint(position, keyframe, keyframe->GetMap());
      keyframe->GetMap()->AddMapPoint(point);
    }
    return point;
  }

  Atlas& atlas_;
  const slamdb::Atlas world_;
  std::map<slamdb::MapPointId, Eigen::Vector3f> position_of_;
  std::map<Coordinates, MapPoint*> point_at_;
};

void SessionOne(const std::string& location) {
  std::puts("session one");
  Atlas atlas;
  Mapper mapper(atlas);
  for (std::size_t i = 0; i < kFirstSession; ++i) mapper.See(i);
  atlas.Save(location, slamdb::WriteOptions{}.With(slamdb::StoreWriteOptions{.provenance = "session one"}));
  std::printf("  saved %lu keyframes, %lu points\n", atlas.KeyFramesInMap(), atlas.MapPointsInMap());
}

// Goes on with the map and dies without a word. Tells through the pipe how many keyframes are surely saved.
[[noreturn]] void SessionTwo(const std::string& location, int pipe) {
  const Atlas::Loaded loaded = Atlas::Load(location);
  Atlas& atlas = *loaded.atlas;
  Expect(loaded.report.whole(), "session two: the map is whole");
  Expect(slamdb::CheckAtlas(ToModel(atlas), {}).ok(), "and sound");
  Mapper mapper(atlas);
  Checkpointer checkpointer(atlas, location, {.interval = 0.05, .provenance = "session two"});
  for (std::size_t i = kFirstSession; i < kFirstSession + 8; ++i) {
    Expect(mapper.See(i)->mnId == i, "a keyframe with a fresh id");
    if (i % 4 != 3) continue;
    checkpointer.Save();
    const unsigned long saved = atlas.KeyFramesInMap();
    if (write(pipe, &saved, sizeof saved) != sizeof saved) break;
  }
  std::fflush(stdout);
  std::raise(SIGKILL);
  std::abort();
}

void SessionThree(const std::string& location, unsigned long saved) {
  std::puts("session three");
  const Atlas::Loaded loaded = Atlas::Load(location);
  Atlas& atlas = *loaded.atlas;
  Mapper mapper(atlas);
  Expect(loaded.report.whole() && slamdb::CheckAtlas(ToModel(atlas), {}).ok(), "the map is whole and sound");
  Expect(saved > kFirstSession && atlas.KeyFramesInMap() >= saved, "nothing that was saved is lost");
  const unsigned long before = atlas.KeyFramesInMap();
  mapper.See(before);
  const slamdb::StoreWriteOptions how{.provenance = "session three"};
  atlas.Save(location, slamdb::WriteOptions{.overwrite = true}.With(how));
  Expect(Atlas::Load(location).atlas->GetAllMaps().front()->KeyFramesInMap() == before + 1, "and it goes on");
}

// Runs session two in a process of its own. Returns how many keyframes it had saved before it was killed.
unsigned long RunAndKillSessionTwo(const std::string& location) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    try {
      SessionTwo(location, ends[1]);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "session two: %s\n", error.what());
      _exit(1);
    }
  }
  close(ends[1]);
  unsigned long saved = 0;
  while (read(ends[0], &saved, sizeof saved) == sizeof saved) {
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  Expect(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL, "session two was killed");
  return saved;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: two_sessions FOLDER\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path store = std::filesystem::path(argv[1]) / "two_sessions.db";
    std::filesystem::create_directories(argv[1]);
    for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(store.string() + suffix);
    const std::string location = store.string() + "#lab";
    SessionOne(location);
    SessionThree(location, RunAndKillSessionTwo(location));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "two_sessions: %s\n", error.what());
    return 1;
  }
}
