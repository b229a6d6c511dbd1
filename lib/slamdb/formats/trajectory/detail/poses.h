// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/format.h"

namespace slamdb::detail {

struct TimedPose {
  double timestamp;       // seconds, finite
  Rigid3f world_from_it;  // camera or body; finite, unit quaternion
  const KeyFrame* keyframe;
};

// The poses of one map, ascending by time, equal times by keyframe id.
struct KeyFrameTrajectory {
  const Map* map;
  std::vector<TimedPose> poses;
};

// Where its cameras, or bodies, are.
std::vector<Eigen::Vector3f> CentersOf(const KeyFrameTrajectory& trajectory);

struct PoseCount {
  std::size_t poses = 0, bad = 0;  // bad: keyframes that are left out for that

  std::string Summary() const;  // `221 poses, 3 bad ones left out`, for Notices::Tell
};

// The trajectories to write, one per chosen map, maps without poses left out.
struct Trajectories {
  std::vector<KeyFrameTrajectory> maps;
  std::size_t bad = 0;  // keyframes that are left out for that

  const KeyFrameTrajectory* Find(const Map& map) const;  // null: it has no poses
  PoseCount Count() const;
  std::string Summary() const { return Count().Summary(); }
};

// Keyframes whose pose or time is not finite are left out with a warning. Warns when the body frame is asked for and a
// keyframe has no IMU calibration, in which case camera and body are the same. Names as a loss what single precision
// rounds visibly. Throws Error when ExportOptions::map is no map.
enum class Rounded {
  kIsLoss,   // of a trajectory, whose digits are compared
  kIsTaken,  // of a picture
};
Trajectories CollectTrajectories(const Atlas& atlas, const Target& target, const WriteOptions& options,
                                 Notices& notices, Rounded rounded = Rounded::kIsLoss);

// Seconds rounded to nanoseconds.
std::int64_t Nanoseconds(double seconds);
// What 64 bits of nanoseconds reach: 292 years to both sides.
bool FitsNanoseconds(double seconds);

// What single precision makes of positions; a rounding that nobody would see is none.
class PositionRounding {
 public:
  void Add(const Eigen::Vector3d& exact, const Eigen::Vector3d& rounded);
  // As a loss: `positions reach 5411933, ...: rounded by up to 0.25: 2 poses`.
  void Tell(std::string_view what_happened, Notices& notices) const;

 private:
  std::size_t poses_ = 0;
  double worst_ = 0, farthest_ = 0;
};

// An atlas that is being made of poses read from a file: ids are given in the order of the file.
class PoseAtlas {
 public:
  void BeginMap(MapId id);  // later poses belong to it; without it, to map 0
  // In double: what is far from the origin must not be rounded before it is turned into the camera's frame.
  const KeyFrame& Add(double timestamp, const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& position);
  Atlas Finish(const ReadOptions& options);  // applies options.selection

 private:
  Atlas atlas_;
  std::uint64_t next_keyframe_ = 0;
};

}  // namespace slamdb::detail
