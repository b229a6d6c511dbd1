// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/relations.h"

#include <algorithm>
#include <cstdint>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/derive.h"

namespace slamdb::synthetic {
namespace {

constexpr std::size_t kPointGrain = 4096, kKeyFrameGrain = 16;

std::size_t Row(const Column<KeyFrame>& keyframes, KeyFrameId id) { return id.value() - keyframes.front().id.value(); }
std::size_t Row(const Column<MapPoint>& points, MapPointId id) { return id.value() - points.front().id.value(); }

void Observe(MapPoint& point, const KeyFrame& keyframe, std::int32_t row) {
  const bool is_right = keyframe.features.is_fisheye_stereo() && row >= keyframe.features.left_count;
  if (point.observations.empty() || point.observations.back().keyframe != keyframe.id)
    point.observations.push_back({keyframe.id});
  (is_right ? point.observations.back().right : point.observations.back().left) = row;
}

void CollectObservations(Map& map) {
  std::vector<std::uint32_t> seen(map.points.size(), 0);
  for (const KeyFrame& keyframe : map.keyframes)
    for (const MapPointId id : keyframe.features.map_points)
      if (id) ++seen[Row(map.points, id)];
  for (std::size_t row = 0; row < map.points.size(); ++row) map.points[row].observations.reserve(seen[row]);
  for (const KeyFrame& keyframe : map.keyframes) {
    const Column<MapPointId>& ids = keyframe.features.map_points;
    for (std::size_t row = 0; row < ids.size(); ++row)
      if (ids[row]) Observe(map.points[Row(map.points, ids[row])], keyframe, static_cast<std::int32_t>(row));
  }
}

void Summarize(MapPoint& point, const Column<KeyFrame>& keyframes, const Rig& rig,
               const std::vector<Pose>& world_from_camera) {
  std::vector<Descriptor> descriptors;
  Eigen::Vector3d directions = Eigen::Vector3d::Zero();
  const Eigen::Vector3d position = point.position.cast<double>();
  const auto add = [&](const KeyFrame& keyframe, std::int32_t row, const Eigen::Vector3d& center) {
    descriptors.push_back(keyframe.features.descriptors[static_cast<std::size_t>(row)]);
    directions += (position - center) / Norm(position - center);
  };
  for (const Observation& observation : point.observations) {
    const std::size_t row = Row(keyframes, observation.keyframe);
    const KeyFrame& keyframe = keyframes[row];
    const Pose& pose = world_from_camera[row];
    point.observation_count += ObservationWeight(keyframe, observation);
    if (observation.left >= 0) add(keyframe, observation.left, pose.translation);
    if (observation.right >= 0) add(keyframe, observation.right, pose * rig.left_from_right.translation);
  }
  if (descriptors.empty()) return;
  point.normal = (directions / static_cast<double>(descriptors.size())).cast<float>();
  point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];

  const Observation& first = point.observations.front();
  const std::size_t row = Row(keyframes, first.keyframe);
  point.reference = first.keyframe;
  point.first_keyframe = static_cast<std::int64_t>(first.keyframe.value());
  point.first_frame = static_cast<std::int64_t>(keyframes[row].frame_id);
  const double distance = Norm(position - world_from_camera[row].translation);
  const Keypoint* keypoint = ObservedKeypoint(keyframes[row], first.left >= 0 ? first.left : first.right);
  const DistanceRange range = DeriveDistanceRange(static_cast<float>(distance), keypoint->octave, rig.pyramid);
  point.min_distance = range.min;
  point.max_distance = range.max;
}

// The connections of one keyframe. `shared` is scratch: a zero for each keyframe, and zeros again when done.
void CountShared(Map& map, KeyFrame& keyframe, std::vector<std::int32_t>& shared) {
  std::vector<std::size_t> rows;
  // In fisheye stereo a point may stand in two slots but is shared once; then its first slot is a left one.
  for (std::size_t slot = 0; slot < keyframe.features.map_points.size(); ++slot) {
    const MapPointId id = keyframe.features.map_points[slot];
    if (!id) continue;
    const Column<Observation>& observers = map.points[Row(map.points, id)].observations;
    const auto own = std::lower_bound(observers.begin(), observers.end(), keyframe.id,
                                      [](const Observation& o, KeyFrameId wanted) { return o.keyframe < wanted; });
    if (own->left >= 0 && own->left != static_cast<std::int32_t>(slot)) continue;
    for (const Observation& observer : observers) {
      if (observer.keyframe == keyframe.id) continue;
      const std::size_t row = Row(map.keyframes, observer.keyframe);
      if (shared[row]++ == 0) rows.push_back(row);
    }
  }
  std::sort(rows.begin(), rows.end());
  keyframe.connections.reserve(rows.size());
  for (const std::size_t row : rows) {
    keyframe.connections.push_back({map.keyframes[row].id, shared[row]});
    shared[row] = 0;
  }
}

KeyFrameId ChooseParent(const KeyFrame& keyframe) {
  Connection best{KeyFrameId(keyframe.id.value() - 1), 0};  // sharing nothing, the one before
  for (const Connection& connection : keyframe.connections)
    if (connection.keyframe < keyframe.id && connection.weight >= best.weight) best = connection;
  return best.keyframe;
}

}  // namespace

void ConnectPoints(Map& map, const Rig& rig, const std::vector<Pose>& world_from_camera, int threads) {
  CollectObservations(map);
  detail::ParallelFor(map.points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) Summarize(map.points[row], map.keyframes, rig, world_from_camera);
  });
}

void ConnectKeyFrames(Map& map, int threads) {
  detail::ParallelFor(map.keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
    thread_local std::vector<std::int32_t> shared;
    shared.assign(map.keyframes.size(), 0);
    for (std::size_t row = begin; row < end; ++row) CountShared(map, map.keyframes[row], shared);
  });
  map.keyframes.front().first_connection = true;
  for (std::size_t row = 1; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    keyframe.parent = ChooseParent(keyframe);
    map.keyframes[Row(map.keyframes, keyframe.parent)].children.push_back(keyframe.id);
  }
}

void AddLoopEdge(Map& map, std::size_t row, std::size_t other_row) {
  KeyFrame &a = map.keyframes[row], &b = map.keyframes[other_row];
  a.loop_edges.push_back(b.id);
  b.loop_edges.push_back(a.id);
  a.not_erase = b.not_erase = true;
}

}  // namespace slamdb::synthetic
