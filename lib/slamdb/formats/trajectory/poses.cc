// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/pose.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

// What the notices tell about keyframes that are not written as they are.
struct Census {
  std::size_t bad = 0, not_finite = 0, without_body = 0;
  PositionRounding rounding;

  void Tell(PoseFrame frame, Rounded rounded, Notices& notices) const {
    if (rounded == Rounded::kIsLoss) rounding.Tell("rounded again as they are written,", notices);
    if (not_finite > 0) notices.Warn("left out because pose or time is not finite: " + Counted(not_finite, "keyframe"));
    if (frame == PoseFrame::kBody && without_body > 0)
      notices.Warn("the camera frame stands in for the body frame, for want of IMU calibration: " +
                   Counted(without_body, "keyframe"));
  }
};

KeyFrameTrajectory Collect(const Map& map, PoseFrame frame, Census& census) {
  KeyFrameTrajectory trajectory{.map = &map, .poses = {}};
  for (const KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) {
      ++census.bad;
      continue;
    }
    const Rigid3f pose = PoseInWorld(keyframe, frame);
    if (!std::isfinite(keyframe.timestamp) || !detail::IsPose(pose)) {
      ++census.not_finite;
      continue;
    }
    if (!keyframe.imu_calibration.is_set) ++census.without_body;
    if (frame == PoseFrame::kCamera)
      census.rounding.Add(ExactCenter(keyframe.camera_from_world), pose.translation.cast<double>());
    trajectory.poses.push_back({keyframe.timestamp, pose, &keyframe});
  }
  std::stable_sort(trajectory.poses.begin(), trajectory.poses.end(), [](const TimedPose& a, const TimedPose& b) {
    return std::pair(a.timestamp, a.keyframe->id) < std::pair(b.timestamp, b.keyframe->id);
  });
  return trajectory;
}

}  // namespace

// Whole seconds and the rest are scaled apart, since their product with 1e9 has more bits than a double.
std::int64_t Nanoseconds(double seconds) {
  const double whole = std::floor(seconds);
  return static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((seconds - whole) * 1e9);
}

bool FitsNanoseconds(double seconds) { return std::abs(seconds) < 9.2e9; }

void PositionRounding::Add(const Eigen::Vector3d& exact, const Eigen::Vector3d& rounded) {
  constexpr double kSeen = 5e-4;  // metres
  const double error = (rounded - exact).norm();
  if (error <= kSeen) return;
  ++poses_;
  worst_ = std::max(worst_, error);
  farthest_ = std::max(farthest_, exact.cwiseAbs().maxCoeff());
}

void PositionRounding::Tell(std::string_view what_happened, Notices& notices) const {
  if (poses_ == 0) return;
  notices.Lose(Concat("positions reach ", Fixed(farthest_, 0), ", where single precision has steps of ",
                      Digits(farthest_ * std::numeric_limits<float>::epsilon(), 1), ": ", what_happened, " by up to ",
                      Digits(worst_, 2), ": ", Counted(poses_, "pose")));
}

std::vector<Eigen::Vector3f> CentersOf(const KeyFrameTrajectory& trajectory) {
  std::vector<Eigen::Vector3f> centers;
  centers.reserve(trajectory.poses.size());
  for (const TimedPose& pose : trajectory.poses) centers.push_back(pose.world_from_it.translation);
  return centers;
}

const KeyFrameTrajectory* Trajectories::Find(const Map& map) const {
  const auto found = std::ranges::find(maps, &map, &KeyFrameTrajectory::map);
  return found == maps.end() ? nullptr : &*found;
}

std::string PoseCount::Summary() const { return CountWritten(poses, "pose", bad); }

PoseCount Trajectories::Count() const {
  PoseCount count{.bad = bad};
  for (const KeyFrameTrajectory& map : maps) count.poses += map.poses.size();
  return count;
}

Trajectories CollectTrajectories(const Atlas& atlas, const Target& target, const WriteOptions& options,
                                 Notices& notices, Rounded rounded) {
  const PoseFrame frame = options.of<TrajectoryOptions>().pose_frame;
  Trajectories trajectories;
  Census census;
  for (const Map* map : ChooseMaps(atlas, options, target)) {
    KeyFrameTrajectory trajectory = Collect(*map, frame, census);
    if (!trajectory.poses.empty()) trajectories.maps.push_back(std::move(trajectory));
  }
  trajectories.bad = census.bad;
  census.Tell(frame, rounded, notices);
  return trajectories;
}

void PoseAtlas::BeginMap(MapId id) {
  Map& map = atlas_.maps.emplace_back();
  map.id = id;
  if (id) atlas_.next_ids.map = std::max(atlas_.next_ids.map, id.value() + 1);
}

const KeyFrame& PoseAtlas::Add(double timestamp, const Eigen::Quaterniond& world_from_camera,
                               const Eigen::Vector3d& position) {
  if (atlas_.maps.empty()) BeginMap(MapId(0));
  Map& map = atlas_.maps.back();
  KeyFrame& keyframe = map.keyframes.emplace_back();
  keyframe.id = KeyFrameId(next_keyframe_);
  keyframe.frame_id = next_keyframe_++;
  keyframe.timestamp = timestamp;
  keyframe.camera_from_world = CameraFromWorld(world_from_camera, position);
  if (map.keyframes.size() == 1) map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = keyframe.id;
  map.max_keyframe_id = keyframe.id.value();
  return keyframe;
}

Atlas PoseAtlas::Finish(const ReadOptions& options) {
  atlas_.next_ids.frame = atlas_.next_ids.keyframe = atlas_.next_ids.initial_keyframe = next_keyframe_;
  const Selection& selection = options.selection;
  if (selection.map) std::erase_if(atlas_.maps, [&](const Map& map) { return map.id != *selection.map; });
  for (Map& map : atlas_.maps)
    std::erase_if(map.keyframes, [&](const KeyFrame& keyframe) { return !selection.Has(keyframe); });
  return std::move(atlas_);
}

}  // namespace slamdb::detail
