// SPDX-License-Identifier: BSD-3-Clause
// slamdb_live_bench [KEYFRAMES POINTS [LOADED_POINTS]]: the live map. For how
// long a checkpoint holds the SLAM threads when 1 % has changed; bringing an atlas to life beside building its index.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "slamdb/live/bridge.h"
#include "slamdb/live/checkpointer.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/index.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::live {
namespace {

double Milliseconds(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// Many points, whose keyframes hold nothing but who sees which.
slamdb::Atlas ManyPoints(std::size_t points) {
  slamdb::Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = points / 250, .points = points, .features = 1500});
  for (slamdb::KeyFrame& keyframe : atlas.maps[0].keyframes) {
    Features& features = keyframe.features;
    features = {.count = features.count, .map_points = std::move(features.map_points)};
  }
  return atlas;
}

// What `measure` returns, from a process of its own: a heap in which nothing was freed yet, as when a session begins.
std::array<double, 3> InOwnProcess(const std::function<std::array<double, 3>()>& measure) {
  int ends[2];
  if (::pipe(ends) != 0) std::abort();
  if (const pid_t child = ::fork(); child == 0) {
    const std::array<double, 3> values = measure();
    ::_exit(::write(ends[1], values.data(), sizeof values) == sizeof values ? 0 : 1);
  } else {
    std::array<double, 3> values{};
    if (child < 0 || ::read(ends[0], values.data(), sizeof values) != sizeof values) std::abort();
    ::waitpid(child, nullptr, 0);
    ::close(ends[0]);
    ::close(ends[1]);
    return values;
  }
}

void MeasureLoading(std::size_t points) {
  const slamdb::Atlas model = ManyPoints(points);
  std::vector<double> index, whole, links;
  for (int round = 0; round < 5; ++round) {
    const std::array<double, 3> times = InOwnProcess([&] {
      slamdb::Atlas copy = model;
      const double indexing = Milliseconds([&] { const AtlasIndex built(model); });
      LiveAtlas live;
      const double loading = Milliseconds([&] { live = FromModel(std::move(copy)); });
      return std::array{indexing, loading, live.report.seconds * 1e3};
    });
    index.push_back(times[0]);
    whole.push_back(times[1]);
    links.push_back(times[2]);
  }
  std::uint64_t observations = 0;
  for (const slamdb::MapPoint& point : model.maps[0].points) observations += point.observations.size();
  std::printf("%zu points, %llu observations: index %.1f ms, FromModel %.1f ms, of which PostLoad %.1f ms\n", points,
              static_cast<unsigned long long>(observations), Median(index), Median(whole), Median(links));
  std::printf("a live point takes %zu bytes, and 16 for each observation\n", sizeof(MapPoint));
}

void MeasurePause(std::size_t keyframes, std::size_t points) {
  const LiveAtlas live =
      FromModel(SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = keyframes, .points = points, .features = 1000}));
  const std::filesystem::path store = std::filesystem::temp_directory_path() / "slamdb_live_bench.db";
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(store.string() + suffix);
  Map* map = live.atlas->GetAllMaps().front();
  const std::vector<MapPoint*> all_points = map->GetAllMapPoints();
  const std::vector<KeyFrame*> all_keyframes = map->GetAllKeyFrames();
  Checkpointer checkpointer(*live.atlas, store.string() + "#bench", {.interval = 0});
  std::printf("%zu keyframes, %zu points: the first save takes %.0f ms, of which SLAM threads wait %.1f ms\n",
              all_keyframes.size(), all_points.size(), checkpointer.LastSave().duration * 1e3,
              checkpointer.LastSave().pause * 1e3);
  std::vector<double> pauses, durations;
  for (std::size_t round = 0; round < 9; ++round) {
    for (std::size_t i = round; i < all_points.size(); i += 100)
      all_points[i]->SetWorldPos(all_points[i]->GetWorldPos() * 1.0001F);
    for (std::size_t i = round; i < all_keyframes.size(); i += 100)
      all_keyframes[i]->SetPose(all_keyframes[i]->GetPose());
    const CheckpointReport report = checkpointer.Save();
    pauses.push_back(report.pause * 1e3);
    durations.push_back(report.duration * 1e3);
  }
  std::printf("1 %% changed: SLAM threads wait %.2f ms (greatest %.2f), a save takes %.0f ms\n", Median(pauses),
              *std::max_element(pauses.begin(), pauses.end()), Median(durations));
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(store.string() + suffix);
}

}  // namespace
}  // namespace slamdb::live

int main(int argc, char** argv) {
  const auto number = [&](int i, std::size_t otherwise) {
    return argc > i ? static_cast<std::size_t>(std::strtoull(argv[i], nullptr, 10)) : otherwise;
  };
  slamdb::live::MeasurePause(number(1, 1000), number(2, 100'000));
  slamdb::live::MeasureLoading(number(3, 1'000'000));
}
