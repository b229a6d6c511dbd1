// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/view/detail/encode.h"

namespace slamdb::view {
namespace {

// Of a keyframe's `flags`.
enum Flags : std::uint8_t { kBad = 1, kNowhere = 2, kFirstOfMap = 4 };

double EarliestTime(const Scene& scene) {
  double earliest = std::numeric_limits<double>::infinity();
  scene.ForEachKeyFrame([&](const SceneAtlas&, std::uint32_t, const KeyFrame& keyframe) {
    if (std::isfinite(keyframe.timestamp)) earliest = std::min(earliest, keyframe.timestamp);
  });
  return std::isfinite(earliest) ? earliest : 0;
}

struct Pose {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  Quaternionf world_from_camera = Quaternionf::Identity();
  bool known = false;
};

Pose PoseOf(const KeyFrame& keyframe) {
  const Quaternionf rotation = keyframe.camera_from_world.Normalized().rotation.conjugate();
  const Eigen::Vector3f center = CameraCenter(keyframe);
  if (!detail::IsPose(keyframe.camera_from_world) || !center.allFinite()) return {};
  return {center, rotation, true};
}

}  // namespace

KeyFrameColumns EncodeKeyFrames(const Scene& scene) {
  VarintColumn ids, cameras, origins, parents;
  std::string times, poses, flags;
  const double origin = EarliestTime(scene);
  std::int64_t row = 0;
  scene.ForEachKeyFrame([&](const SceneAtlas& atlas, std::uint32_t map, const KeyFrame& keyframe) {
    ids.AddDifference(keyframe.id.value());
    AppendBytes(times, keyframe.timestamp - origin);
    const Pose pose = PoseOf(keyframe);
    const Quaternionf& q = pose.world_from_camera;
    AppendBytes(poses, pose.center.x(), pose.center.y(), pose.center.z(), q.x(), q.y(), q.z(), q.w());
    const std::uint32_t camera = atlas.numbered.index().CameraRow(keyframe.camera);
    cameras.Add(camera == kNoRow ? 0 : std::uint64_t{atlas.first_camera} + camera + 1);
    origins.Add(keyframe.origin_map);
    parents.AddSigned(atlas.KeyFrameRow(map, keyframe.parent) - row);
    const bool first = keyframe.id == atlas.atlas().maps[map].first_keyframe;
    flags.push_back(
        static_cast<char>((keyframe.bad ? kBad : 0) | (pose.known ? 0 : kNowhere) | (first ? kFirstOfMap : 0)));
    ++row;
  });
  return {.columns = {{"keyframes/id", ids.Take()},
                      {"keyframes/time", std::move(times)},
                      {"keyframes/pose", std::move(poses)},
                      {"keyframes/camera", cameras.Take()},
                      {"keyframes/origin", origins.Take()},
                      {"keyframes/parent", parents.Take()},
                      {"keyframes/flags", std::move(flags)}},
          .origin_of_time = origin};
}

}  // namespace slamdb::view
