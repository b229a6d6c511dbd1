// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/keyframe_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slamdb/formats/colmap/options.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/g2o/detail/g2o.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/detail/lens_numbers.h"
#include "slamdb/model/detail/local_origin.h"
#include "slamdb/model/detail/rounding.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

std::vector<KeyFramePose> OfTrajectories(const HeldSource& held, const ReadOptions& options, Notices& notices) {
  std::vector<KeyFramePose> poses;
  for (const MapTrajectory& map : ReadTrajectories(held, options, &notices))
    for (const TrajectoryPose& pose : map.poses)
      poses.push_back({.timestamp = pose.timestamp, .world_from_camera = {1, pose.rotation, pose.position}});
  return poses;
}

// Whole seconds only are no times but places in an order: readers put those where a file has no times, and files of
// pictures are numbered.
bool HasTimes(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) {
      return std::isfinite(keyframe.timestamp) && keyframe.timestamp != std::floor(keyframe.timestamp);
    });
  });
}

std::vector<KeyFramePose> OfAtlas(const Atlas& atlas) {
  const AtlasIndex index(atlas);
  const bool has_times = HasTimes(atlas);
  std::vector<KeyFramePose> poses;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      if (keyframe.bad) continue;
      const Rigid3f& recorded = keyframe.camera_from_world;
      const Similarity3d camera_from_world{1, Eigen::Quaternionf(recorded.rotation).cast<double>().normalized(),
                                           recorded.translation.cast<double>()};
      poses.push_back({.keyframe = keyframe.id,
                       .timestamp = keyframe.timestamp,
                       .world_from_camera = camera_from_world.Inverse(),
                       .has_time = has_times,
                       .lens = detail::LensNumbers(keyframe, index.FindCamera(keyframe.camera))});
    }
  return poses;
}

std::vector<PointPosition> PointsOf(const Atlas& atlas) {
  std::vector<PointPosition> points;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points)
      if (!point.bad && !point.observations.empty()) {
        const Observation& seen = point.observations.front();
        points.push_back({.point = point.id,
                          .position = point.position.cast<double>(),
                          .seen_by = seen.keyframe,
                          .keypoint = seen.left >= 0 ? seen.left : seen.right});
      }
  return points;
}

// As the reader of COLMAP does, but only where floats would round by more than is a loss: few poses close together are
// soon far for what they spread, and may have been moved there. Returns what was taken off.
Eigen::Vector3d MoveToLocalOrigin(std::vector<KeyFramePose>& poses) {
  std::vector<Eigen::Vector3d> places;
  for (const KeyFramePose& pose : poses) places.push_back(pose.world_from_camera.translation);
  const Eigen::Vector3d origin = detail::LocalOriginOf(std::move(places));
  constexpr double kHalfStep = std::numeric_limits<float>::epsilon() / 2;
  if (origin.norm() * kHalfStep <= detail::Rounding::kMost) return Eigen::Vector3d::Zero();
  for (KeyFramePose& pose : poses) pose.world_from_camera.translation -= origin;
  return origin;
}

}  // namespace

std::vector<KeyFramePose> ReadKeyFramePoses(const HeldSource& held, const ReadOptions& options, Notices* notices,
                                            std::vector<PointPosition>* points, Eigen::Vector3d* origin) {
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  ReadOptions poses = options;
  poses.needs = Content::kPoses;
  poses.features = FeatureColumns::kNone;
  if (origin != nullptr) *origin = Eigen::Vector3d::Zero();
  poses.of<ColmapReadOptions>().origin = origin;
  const Format& format = detail::FormatToRead(held.source(), poses);
  if (IsTrajectory(format) || format.id == detail::kG2oFormat.id) {
    std::vector<KeyFramePose> exact =
        IsTrajectory(format) ? OfTrajectories(held, poses, heard) : detail::ReadG2oPoses(held.source(), heard);
    if (origin != nullptr) *origin = MoveToLocalOrigin(exact);
    return exact;
  }
  const Atlas atlas = ReadAtlas(held, poses, &heard);
  if (points != nullptr) *points = PointsOf(atlas);
  return OfAtlas(atlas);
}

}  // namespace slamdb
