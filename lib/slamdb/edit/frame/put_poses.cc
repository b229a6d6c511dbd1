// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/put_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/detail/lens_numbers.h"
#include "slamdb/model/detail/local_origin.h"
#include "slamdb/model/detail/rounding.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

void RequireFinite(const std::vector<KeyFramePose>& poses, const std::vector<PointPosition>& points) {
  for (const KeyFramePose& pose : poses)
    if (!detail::IsPose(pose.world_from_camera))
      throw Error(ErrorKind::kUsage, Concat("the new pose of ", pose.keyframe, " is none, or not finite"));
  for (const PointPosition& point : points)
    if (!point.position.cast<float>().allFinite())
      throw Error(ErrorKind::kUsage, Concat("the new position of ", point.point, " is not finite"));
}

// Whether a pose is the one that is there, but for what single precision, in which atlases keep it, cannot tell.
bool IsThere(const Similarity3d& pose, const Similarity3d& there) {
  constexpr double kRounding = std::numeric_limits<float>::epsilon();
  const Eigen::Vector4d coefficients = pose.rotation.coeffs(), others = there.rotation.coeffs();
  const double turn = std::min((coefficients - others).norm(), (coefficients + others).norm());
  const double shift = (pose.translation - there.translation).norm();
  return std::abs(pose.scale - 1) <= kRounding && turn <= kRounding && shift <= kRounding * there.translation.norm();
}

// Keyframes of all maps by time.
class Clock {
 public:
  explicit Clock(const Atlas& atlas) {
    for (std::uint32_t map = 0; map < atlas.maps.size(); ++map)
      for (std::uint32_t row = 0; row < atlas.maps[map].keyframes.size(); ++row)
        if (const KeyFrame& keyframe = atlas.maps[map].keyframes[row];
            std::isfinite(keyframe.timestamp) && !keyframe.bad)
          ticks_.push_back({keyframe.timestamp, {map, row}});
    std::ranges::stable_sort(ticks_, {}, &Tick::time);
  }

  EntityRow Nearest(double time, double most) const {
    auto after = std::ranges::lower_bound(ticks_, time, {}, &Tick::time);
    if (after != ticks_.begin() && (after == ticks_.end() || time - std::prev(after)->time <= after->time - time))
      --after;
    const bool near = after != ticks_.end() && std::abs(after->time - time) <= most;
    return near ? after->place : EntityRow();
  }

 private:
  struct Tick {
    double time;
    EntityRow place;
  };
  std::vector<Tick> ticks_;
};

// What is new in one map: by row.
struct News {
  std::vector<std::pair<std::uint32_t, Similarity3d>> poses;  // world_from_camera
  std::vector<std::pair<std::uint32_t, Eigen::Vector3d>> points;
  bool any() const { return !poses.empty() || !points.empty(); }
};

class Putter {
 public:
  Putter(Atlas& atlas, const PutPosesOptions& options)
      : atlas_(atlas), options_(options), index_(atlas), news_(atlas.maps.size()) {}

  void Find(const std::vector<KeyFramePose>& poses) {
    std::optional<Clock> clock;
    std::vector<std::vector<std::uint8_t>> taken;
    for (const Map& map : atlas_.maps) taken.emplace_back(map.keyframes.size(), 0);
    for (const KeyFramePose& pose : poses) {
      if (!pose.keyframe && !clock) clock.emplace(atlas_);
      const EntityRow place = pose.keyframe ? index_.LocateKeyFrame(pose.keyframe)
                                            : clock->Nearest(pose.timestamp, options_.max_time_difference);
      if (!place || !detail::IsPosed(atlas_.maps[place.map].keyframes[place.row]) ||
          std::exchange(taken[place.map][place.row], 1) != 0) {
        ++report_.unknown_poses;
        continue;
      }
      const KeyFrame& keyframe = atlas_.maps[place.map].keyframes[place.row];
      RequireSameTime(pose, keyframe);
      CompareLenses(pose, keyframe);
      news_[place.map].poses.emplace_back(place.row, CameraOf(pose, keyframe));
      ++report_.keyframes;
    }
    for (const PointPosition& point : options_.points) {
      const EntityRow place = index_.LocatePoint(point.point);
      if (!place || !IsSamePoint(atlas_.maps[place.map].points[place.row], point)) {
        ++report_.unknown_points;
        continue;
      }
      news_[place.map].points.emplace_back(place.row, point.position);
      ++report_.points;
    }
    if (report_.keyframes + report_.points == 0)
      throw Error(ErrorKind::kNotPossible,
                  Concat("none of the ", Counted(poses.size(), "pose"), " is of a keyframe of the atlas"));
  }

  PutPosesReport Put() {
    AddOrigin();
    for (std::size_t map = 0; map < news_.size(); ++map)
      if (news_[map].any()) PutMap(atlas_.maps[map], news_[map]);
    Warn(report_.unknown_poses, "pose",
         " left out: of no good keyframe of the atlas, or of one that had a pose already");
    Warn(report_.unknown_points, "position",
         " left out: of no good point of the atlas, or of one that is seen elsewhere");
    Warn(report_.followers, "keyframe", " without a new pose went with the parent in the spanning tree");
    if (other_lenses_ > 0)
      report_.warnings.push_back(Concat(Counted(other_lenses_, "pose"), " of another lens than the atlas has, as ",
                                        lens_example_,
                                        ": neither poses nor points fit the keypoints of the atlas as they should; "
                                        "optimise again with the lens held as it is"));
    Notices rounded;
    rounding_.Tell(rounded);
    for (const Notice& notice : rounded.items()) report_.losses.push_back(notice.text);
    return std::move(report_);
  }

 private:
  // Ids of another atlas are of other keyframes.
  void RequireSameTime(const KeyFramePose& pose, const KeyFrame& keyframe) const {
    const bool known = pose.keyframe.has_value() && pose.has_time && std::isfinite(pose.timestamp) &&
                       std::isfinite(keyframe.timestamp);
    if (!known || std::abs(pose.timestamp - keyframe.timestamp) <= options_.max_time_difference) return;
    throw Error(ErrorKind::kNotPossible,
                Concat("the poses are of another atlas: ", keyframe.id, " is of ", detail::SecondsText(pose.timestamp),
                       " s there, and of ", detail::SecondsText(keyframe.timestamp), " s in this one"));
  }

  void CompareLenses(const KeyFramePose& pose, const KeyFrame& keyframe) {
    if (pose.lens.empty()) return;
    const std::vector<double> lens = detail::LensNumbers(keyframe, index_.FindCamera(keyframe.camera));
    if (lens.empty() || detail::AreLensesAlike(pose.lens, lens)) return;
    if (other_lenses_++ == 0)
      lens_example_ = Concat("that of ", keyframe.id, " (fx fy cx cy, distortion: ", detail::LensText(pose.lens),
                             "; in the atlas ", detail::LensText(lens), ")");
  }

  Similarity3d CameraOf(const KeyFramePose& pose, const KeyFrame& keyframe) const {
    if (!options_.of_body) return pose.world_from_camera;
    const ImuCalibration& calibration = keyframe.imu_calibration;
    if (!calibration.is_set || !detail::IsPose(calibration.body_from_camera))
      throw Error(ErrorKind::kNotPossible,
                  Concat(keyframe.id, " has no IMU calibration, which leads from the body to the camera"));
    const Eigen::Quaterniond rotation = Eigen::Quaternionf(calibration.body_from_camera.rotation).cast<double>();
    const Eigen::Vector3d translation = calibration.body_from_camera.translation.cast<double>();
    const Similarity3d& world_from_body = pose.world_from_camera;  // whose scale is of the map's lengths
    const Eigen::Quaterniond turn = world_from_body.rotation.normalized();
    return {world_from_body.scale, turn * rotation.normalized(),
            world_from_body.translation + world_from_body.scale * (turn * translation)};
  }

  // Where an origin was taken off, poses are in no frame yet: the atlas tells by what it has of them.
  void AddOrigin() {
    if (options_.origin.isZero(0)) return;
    const Eigen::Vector3d shift = detail::WholeMiddleOf(Shifts());
    const bool is_as_far = (shift + options_.origin).norm() < shift.norm();
    const Eigen::Vector3d added = is_as_far ? options_.origin : Eigen::Vector3d(-shift);
    for (News& news : news_) {
      for (auto& [row, pose] : news.poses) pose.translation += added;
      for (auto& [row, position] : news.points) position += added;
    }
    if (!is_as_far)
      report_.warnings.push_back(
          Concat("positions stay as the atlas has them: without ", detail::OriginText(options_.origin - added),
                 ", which the poses have (in whole units, the median of how far they are from the atlas: "
                 "by how much of it all were moved cannot be told)"));
  }

  // From where the atlas has them to where they are put.
  std::vector<Eigen::Vector3d> Shifts() const {
    std::vector<Eigen::Vector3d> shifts;
    for (std::size_t map = 0; map < news_.size(); ++map) {
      for (const auto& [row, pose] : news_[map].poses)
        shifts.push_back(pose.translation - detail::ExactCenter(atlas_.maps[map].keyframes[row].camera_from_world));
      for (const auto& [row, position] : news_[map].points)
        if (const MapPoint& point = atlas_.maps[map].points[row]; detail::IsPlaced(point))
          shifts.push_back(position - point.position.cast<double>());
    }
    return shifts;
  }

  static bool IsSamePoint(const MapPoint& point, const PointPosition& position) {
    if (point.bad || !position.seen_by) return !point.bad;
    return std::ranges::any_of(point.observations, [&](const Observation& seen) {
      return seen.keyframe == position.seen_by && (seen.left == position.keypoint || seen.right == position.keypoint);
    });
  }

  void PutMap(Map& map, const News& news) {
    const detail::MapStates before(map);
    detail::MapStates after = before;
    detail::Moved moved{std::vector<std::uint8_t>(map.keyframes.size(), 0),
                        std::vector<std::uint8_t>(map.points.size(), 0)};
    std::vector<Similarity3d> motions(map.keyframes.size());
    for (const auto& [row, pose] : news.poses) {
      moved.keyframes[row] = 1;
      const Similarity3d old = before.poses[row].WorldFromCamera();
      const Similarity3d now{pose.scale, pose.rotation.normalized(), pose.translation};
      if (IsThere(now, old)) continue;
      after.poses[row].SetWorldFromCamera(now.rotation, now.translation);
      motions[row] = now * old.Inverse();
      report_.largest_shift = std::max(report_.largest_shift, (pose.translation - old.translation).norm());
    }
    for (const auto& [row, position] : news.points) {
      after.points[row] = position;
      moved.points[row] = 1;
    }
    const detail::MapStates put = after;
    detail::CarryAlong(map, moved, motions, after);
    for (std::size_t row = 0; row < put.poses.size(); ++row)
      report_.followers += put.poses[row].values != after.poses[row].values ? 1 : 0;
    detail::Record(before, after, options_.threads, map);
    AddRounding(map, news);
    ++report_.maps;
  }

  void AddRounding(const Map& map, const News& news) {
    for (const auto& [row, pose] : news.poses)
      rounding_.AddPose(map.keyframes[row].camera_from_world, pose.translation);
    for (const auto& [row, position] : news.points)
      rounding_.AddLoss((map.points[row].position.cast<double>() - position).cwiseAbs().maxCoeff());
  }

  void Warn(std::uint64_t count, std::string_view noun, std::string_view what) {
    if (count > 0) report_.warnings.push_back(Counted(count, noun) + std::string(what));
  }

  Atlas& atlas_;
  const PutPosesOptions& options_;
  const AtlasIndex index_;
  std::vector<News> news_;
  std::uint64_t other_lenses_ = 0;  // poses
  std::string lens_example_;
  detail::Rounding rounding_;
  PutPosesReport report_;
};

}  // namespace

PutPosesReport PutPoses(Atlas& atlas, const std::vector<KeyFramePose>& poses, const PutPosesOptions& options) {
  RequireFinite(poses, options.points);
  Putter putter(atlas, options);
  putter.Find(poses);
  return putter.Put();
}

}  // namespace slamdb
