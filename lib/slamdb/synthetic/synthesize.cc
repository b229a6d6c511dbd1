// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/synthesize.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/synthetic/detail/inertial.h"
#include "slamdb/synthetic/detail/random.h"
#include "slamdb/synthetic/detail/relations.h"
#include "slamdb/synthetic/detail/rig.h"
#include "slamdb/synthetic/detail/room.h"
#include "slamdb/synthetic/detail/view.h"

// Steps: plan a room that fits the numbers, hang points on its wall, let a camera go round and list what each keyframe
// sees; then all else follows from that: observations, normals and descriptors of points, covisibility, spanning tree.
namespace slamdb {
namespace {

using namespace synthetic;  // NOLINT(google-build-using-namespace): the folder's own

constexpr double kStart = 1.7e9;                 // seconds: a timestamp in our times
constexpr std::uint64_t kFramesPerKeyframe = 5;  // 20 Hz
constexpr std::size_t kLoopEdgesPerLap = 8;
constexpr std::size_t kBatch = 64;  // keyframes per thread between two calls of progress

void CheckOptions(const SyntheticOptions& options) {
  const auto require = [](bool condition, const char* problem) {
    if (!condition) throw Error(ErrorKind::kUsage, problem);
  };
  require(options.maps >= 1, "an atlas needs at least 1 map");
  require(options.keyframes >= 2, "a map needs at least 2 keyframes, so that points can be seen twice");
  require(options.features >= 1 && options.features <= 1'000'000, "features per keyframe must be 1 to 1000000");
  require(options.outliers >= 0 && options.outliers < 1, "the share of outliers must be 0 or above, and below 1");
  require(options.flipped_bits >= 0 && options.flipped_bits <= 256, "the flipped bits must be 0 to 256");
  if (options.sessions) {
    require(options.sessions->overlap >= 0 && options.sessions->overlap <= 1, "the overlap must be 0 to 1");
    require(options.sessions->common >= 0 && options.sessions->common <= 1,
            "the share of common points must be 0 to 1");
  }
  require(options.pixel_noise >= 0 && options.pixel_noise <= 5, "the pixel noise must be 0 to 5 pixels");
}

// Where one map stands among the ids of the atlas.
struct Ids {
  std::uint64_t map, first_keyframe, first_point;
};

Vocabulary VocabularyOf(const SyntheticOptions& options) {
  const std::string number = options.vocabulary == 0 ? "" : std::to_string(options.vocabulary);
  std::string checksum = "5e1f00d5e1f00d5e1f00d5e1f00d5e1f";
  const std::string digits = detail::Hex(options.vocabulary);
  if (options.vocabulary != 0) checksum.replace(0, digits.size(), digits);
  return {"synthetic" + number + ".txt", checksum};
}

ImuBias DrawBias(const SyntheticOptions& options, std::uint64_t map) {
  Random random({options.seed, map, kBias});
  ImuBias bias;
  for (int i = 0; i < 3; ++i) bias.accelerometer[i] = static_cast<float>(0.05 * random.Normal());
  for (int i = 0; i < 3; ++i) bias.gyroscope[i] = static_cast<float>(0.01 * random.Normal());
  return bias;
}

class MapMaker {
 public:
  MapMaker(const SyntheticOptions& options, const Rig& rig, const RoomPlan& plan, Ids ids)
      : options_(options),
        rig_(rig),
        ids_(ids),
        room_(MakeRoom(options, rig, plan, ids.map)),
        view_{options, rig, room_, ids.map, ids.first_point},
        bias_(DrawBias(options, ids.map)),
        poses_(options.keyframes) {}

  Similarity3d RoomFromMap() const { return room_.SharedFromMap(); }

  Map Make() {
    map_.id = MapId(ids_.map);
    MakePoints();
    MakeKeyFrames();
    ConnectPoints(map_, rig_, poses_, options_.threads);
    ConnectKeyFrames(map_, options_.threads);
    if (options_.loops && !options_.sessions) CloseLoops();
    const KeyFrameId first = map_.keyframes.front().id;
    map_.initial_keyframe = map_.first_keyframe = map_.lowest_keyframe = first;
    map_.origins = {first};
    map_.max_keyframe_id = map_.keyframes.back().id.value();
    map_.imu_initialized = map_.inertial = map_.imu_ba1 = map_.imu_ba2 = options_.inertial;
    return std::move(map_);
  }

 private:
  void MakePoints() {
    map_.points.resize(options_.points);
    for (std::size_t row = 0; row < options_.points; ++row) {
      map_.points[row].id = MapPointId(ids_.first_point + row);
      map_.points[row].position =
          ((room_.world_from_room * room_.points[room_.before + row]) * room_.scale).cast<float>();
    }
  }

  void MakeKeyFrames() {
    const std::size_t batch = kBatch * static_cast<std::size_t>(detail::ThreadCount(options_.threads));
    const std::string stage = "synthesizing map " + std::to_string(ids_.map);
    map_.keyframes.resize(options_.keyframes);
    for (std::size_t begin = 0; begin < options_.keyframes; begin += batch) {
      if (options_.progress)
        options_.progress(stage, static_cast<double>(begin) / static_cast<double>(options_.keyframes));
      detail::ParallelFor(std::min(batch, options_.keyframes - begin), 4, options_.threads,
                          [&](std::size_t first, std::size_t last) {
                            for (std::size_t row = begin + first; row < begin + last; ++row) MakeKeyFrame(row);
                          });
    }
    if (options_.progress) options_.progress(stage, 1);
  }

  void MakeKeyFrame(std::size_t row) {
    const double seconds = kKeyframeInterval * static_cast<double>(row);
    const double pause = 5 + kKeyframeInterval * static_cast<double>(options_.keyframes);  // from map to map
    KeyFrame& keyframe = map_.keyframes[row];
    keyframe = BlankKeyFrame(rig_);
    keyframe.id = KeyFrameId(ids_.first_keyframe + row);
    keyframe.frame_id = keyframe.id.value() * kFramesPerKeyframe;
    keyframe.timestamp = kStart + pause * static_cast<double>(ids_.map) + seconds;
    keyframe.origin_map = static_cast<std::uint32_t>(ids_.map);
    poses_[row] = room_.WorldFromCamera(seconds);
    poses_[row].translation *= room_.scale;
    keyframe.camera_from_world = poses_[row].Inverse().Recorded();
    keyframe.features = view_.See(row);
    if (!options_.inertial) return;
    AddInertial(keyframe, rig_, room_, seconds, bias_, row == 0);
    if (row > 0) keyframe.previous = KeyFrameId(keyframe.id.value() - 1);
    if (row + 1 < options_.keyframes) keyframe.next = KeyFrameId(keyframe.id.value() + 1);
  }

  // Keyframes of the second lap find the ones of the first that stood where they stand.
  void CloseLoops() {
    const double per_lap = 2 * kPi / room_.plan.step;
    const auto lap = static_cast<std::size_t>(std::ceil(per_lap));
    const std::size_t gap = std::max<std::size_t>(lap / kLoopEdgesPerLap / 4, 2);
    for (std::size_t row = lap; row < options_.keyframes; row += gap) {
      AddLoopEdge(map_, static_cast<std::size_t>(static_cast<double>(row) - per_lap + 0.5), row);
      ++map_.big_change_index;
    }
  }

  const SyntheticOptions& options_;
  const Rig& rig_;
  const Ids ids_;
  const Room room_;
  const View view_;
  const ImuBias bias_;
  std::vector<Pose> poses_;  // world_from_camera
  Map map_;
};

}  // namespace

Atlas SynthesizeAtlas(const SyntheticOptions& options) { return SynthesizeSessions(options).atlas; }

SyntheticSessions SynthesizeSessions(const SyntheticOptions& options) {
  CheckOptions(options);
  const Rig rig = MakeRig(options.sensor);
  const RoomPlan plan = PlanRoom(options, rig);
  SyntheticSessions sessions;
  Atlas& atlas = sessions.atlas;
  atlas.vocabulary = VocabularyOf(options);
  atlas.cameras = rig.cameras;
  Counters& next = atlas.next_ids;
  for (int map = 0; map < options.maps; ++map) {
    MapMaker maker(options, rig, plan, {next.map, next.keyframe, next.map_point});
    atlas.maps.push_back(maker.Make());
    sessions.room_from_map.push_back(maker.RoomFromMap());
    ++next.map;
    next.keyframe += options.keyframes;
    next.map_point += options.points;
  }
  next.frame = next.keyframe * kFramesPerKeyframe;
  next.camera = atlas.cameras.size();
  next.initial_keyframe = next.keyframe;
  return sessions;
}

void ScaleTo(std::uint64_t bytes, SyntheticOptions& options) {
  constexpr std::size_t kGridBytes = 64 * 48 * 8;  // a count for each cell
  constexpr std::size_t kFeatureBytes = 136;       // keypoint twice, descriptor, depth, map point, grid and words
  constexpr std::size_t kPointBytes = 480;         // with its observations
  constexpr std::size_t kPointsPerKeyframe = 45;   // which fit into half the features, as a fisheye pair has them
  const std::size_t keyframe = kGridBytes + options.features * kFeatureBytes + kPointsPerKeyframe * kPointBytes;
  options.keyframes = std::max<std::size_t>(2, bytes / keyframe / static_cast<std::size_t>(options.maps));
  options.points = options.keyframes * kPointsPerKeyframe;
}

}  // namespace slamdb
