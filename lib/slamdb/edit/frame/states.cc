// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/detail/states.h"

#include <algorithm>
#include <cstring>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kGrain = 2048;

// Bit by bit, so that what is not a number and was not touched is the same.
template <class Value>
bool IsSame(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof(Value)) == 0;
}

// Steps that run away are not recorded.
bool IsRecordable(const PoseState& pose) {
  return pose.rotation().coeffs().allFinite() && pose.translation().cast<float>().allFinite();
}

bool IsIdentity(const Similarity3d& motion) {
  return motion.scale == 1 && motion.rotation.vec().isZero(0) && motion.translation.isZero(0);
}

// A velocity that was not estimated turns with its keyframe.
Eigen::Vector3f VelocityOf(const KeyFrame& keyframe, std::size_t row, const MapStates& before, const MapStates& after) {
  if (!keyframe.velocity.allFinite() || keyframe.velocity.isZero(0)) return keyframe.velocity;
  const Eigen::Vector3f estimated = after.velocities[row].cast<float>();
  if (!IsSame(after.velocities[row], before.velocities[row]) && estimated.allFinite()) return estimated;
  const Eigen::Quaterniond turn = after.poses[row].rotation().conjugate() * before.poses[row].rotation();
  return (turn * keyframe.velocity.cast<double>()).cast<float>();
}

void RecordPose(const PoseState& pose, KeyFrame& keyframe) {
  keyframe.camera_from_world = {Quaternionf(pose.rotation().cast<float>()), pose.translation().cast<float>()};
  if (!keyframe.imu_calibration.is_set) return;
  const Eigen::Vector3d body = keyframe.imu_calibration.camera_from_body.translation.cast<double>();
  if (body.allFinite())
    keyframe.body_position = (pose.rotation().conjugate() * (body - pose.translation())).cast<float>();
}

// As ORB-SLAM3's KeyFrame::SetNewBias.
void RecordBias(const Vector6d& bias, KeyFrame& keyframe) {
  keyframe.imu_bias = {.accelerometer = bias.tail<3>().cast<float>(), .gyroscope = bias.head<3>().cast<float>()};
  ImuPreintegration& imu = keyframe.preintegration;
  imu.updated_bias = keyframe.imu_bias;
  imu.bias_change << keyframe.imu_bias.gyroscope - imu.bias.gyroscope,
      keyframe.imu_bias.accelerometer - imu.bias.accelerometer;
}

}  // namespace

MapStates::MapStates(const Map& map) {
  poses.resize(map.keyframes.size());
  velocities.reserve(map.keyframes.size());
  biases.resize(map.keyframes.size());
  points.reserve(map.points.size());
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row];
    velocities.push_back(keyframe.velocity.cast<double>());
    biases[row] << keyframe.imu_bias.gyroscope.cast<double>(), keyframe.imu_bias.accelerometer.cast<double>();
    if (!IsPosed(keyframe)) continue;
    poses[row].rotation() = keyframe.camera_from_world.rotation.cast<double>().normalized();
    poses[row].translation() = keyframe.camera_from_world.translation.cast<double>();
  }
  for (const MapPoint& point : map.points) points.push_back(point.position.cast<double>());
}

void MapStates::Move(const Similarity3d& target_from_source, const Moved& moved) {
  for (std::size_t row = 0; row < poses.size(); ++row) {
    if (!moved.keyframes[row]) continue;
    const Similarity3d pose = target_from_source * poses[row].WorldFromCamera();
    poses[row].SetWorldFromCamera(pose.rotation, pose.translation);
    velocities[row] = target_from_source.rotation * velocities[row];
  }
  for (std::size_t row = 0; row < points.size(); ++row)
    if (moved.points[row]) points[row] = target_from_source * points[row];
}

bool IsPosed(const KeyFrame& keyframe) { return !keyframe.bad && IsPose(keyframe.camera_from_world); }

bool IsPlaced(const MapPoint& point) { return !point.bad && point.position.allFinite(); }

std::vector<Similarity3d> MotionsOf(const MapStates& before, const MapStates& after) {
  std::vector<Similarity3d> motions;
  motions.reserve(before.poses.size());
  for (std::size_t row = 0; row < before.poses.size(); ++row)
    motions.push_back(IsSame(before.poses[row], after.poses[row])
                          ? Similarity3d()
                          : after.poses[row].WorldFromCamera() * before.poses[row].WorldFromCamera().Inverse());
  return motions;
}

void CarryAlong(const Map& map, const Moved& moved, std::vector<Similarity3d>& motions, MapStates& states) {
  const IdTable rows = KeyFrameTable(map);
  std::vector<std::uint8_t> settled = moved.keyframes;
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t start = 0; start < map.keyframes.size(); ++start) {
    waiting.clear();
    std::uint32_t row = start;
    while (row != kNoRow && !settled[row]) {
      settled[row] = 1;  // so that a cycle ends
      waiting.push_back(row);
      row = rows.Find(map.keyframes[row].parent.value());
    }
    for (auto follower = waiting.rbegin(); follower != waiting.rend() && row != kNoRow; ++follower) {
      motions[*follower] = motions[row];
      if (!IsPosed(map.keyframes[*follower]) || IsIdentity(motions[row])) continue;
      const Similarity3d pose = motions[row] * states.poses[*follower].WorldFromCamera();
      states.poses[*follower].SetWorldFromCamera(pose.rotation, pose.translation);
    }
  }
  for (std::size_t row = 0; row < map.points.size(); ++row) {
    const MapPoint& point = map.points[row];
    if (moved.points[row] || !IsPlaced(point)) continue;
    std::uint32_t leader = rows.Find(point.reference.value());
    if (leader == kNoRow && !point.observations.empty())
      leader = rows.Find(point.observations.front().keyframe.value());
    if (leader != kNoRow && !IsIdentity(motions[leader])) states.points[row] = motions[leader] * states.points[row];
  }
}

void Record(const MapStates& before, const MapStates& after, int threads, Map& map) {
  const IdTable rows = KeyFrameTable(map);
  std::vector<std::uint8_t> turned(map.keyframes.size(), 0);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    if (!IsPosed(keyframe)) continue;
    turned[row] = !IsSame(after.poses[row].values, before.poses[row].values) && IsRecordable(after.poses[row]);
    if (!turned[row] && IsSame(after.velocities[row], before.velocities[row])) continue;
    keyframe.velocity = VelocityOf(keyframe, row, before, after);
    RecordPose(after.poses[row], keyframe);
    if (!IsSame(after.biases[row], before.biases[row]) && after.biases[row].allFinite())
      RecordBias(after.biases[row], keyframe);
  }
  const auto find = [&](KeyFrameId id) -> const KeyFrame* {
    const std::uint32_t row = rows.Find(id.value());
    return row == kNoRow ? nullptr : &map.keyframes[row];
  };
  const auto seen_from_elsewhere = [&](const MapPoint& point) {
    return std::ranges::any_of(point.observations, [&](const Observation& observation) {
      const std::uint32_t row = rows.Find(observation.keyframe.value());
      return row != kNoRow && turned[row];
    });
  };
  ParallelFor(map.points.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      MapPoint& point = map.points[row];
      const bool moved = !IsSame(after.points[row], before.points[row]) && after.points[row].cast<float>().allFinite();
      if (moved) point.position = after.points[row].cast<float>();
      if (!IsPlaced(point) || (!moved && !seen_from_elsewhere(point))) continue;
      if (const auto normal = ObservedNormal(point, find); normal && normal->allFinite()) point.normal = *normal;
      const KeyFrame* reference = find(point.reference);
      if (reference == nullptr) continue;
      const DistanceRange range = ObservedRange(point, *reference);
      if (!(range.max > 0 && range.min > 0)) continue;
      point.min_distance = range.min;
      point.max_distance = range.max;
    }
  });
}

}  // namespace slamdb::detail
