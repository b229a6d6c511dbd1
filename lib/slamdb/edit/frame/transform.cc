// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/transform.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/unit.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/up.h"

namespace slamdb {
namespace {

constexpr std::size_t kKeyFramesPerBlock = 32, kPointsPerBlock = 4096;

bool IsIdentity(const Similarity3d& transform) {
  return transform.scale == 1 && transform.rotation.vec().isZero(0) && transform.translation.isZero(0);
}

// A merge scale is set only in keyframes that were merged and garbage in all others. What is no plausible scale, by the
// rule that `check` has for it, stays as it is.
bool IsMergeScale(float scale) { return scale >= 1e-3F && scale <= 1e3F; }

// Applies x' = s R x + t to one entity after another. All in double; each field is rounded once.
class Mover {
 public:
  explicit Mover(const Similarity3d& target_from_source)
      : scale_(target_from_source.scale),
        turns_(!target_from_source.rotation.vec().isZero(0)),
        rotation_(target_from_source.rotation.normalized()),
        matrix_(rotation_.toRotationMatrix()),
        translation_(target_from_source.translation) {}

  void Move(KeyFrame& keyframe) const {
    // Before the pose, because it hangs on the camera's old centre.
    keyframe.body_position = BodyPosition(keyframe);
    keyframe.camera_from_world = CameraFromTarget(keyframe.camera_from_world);
    keyframe.velocity = Turned(keyframe.velocity, scale_);
    if (scale_ != 1) Scale(keyframe);
  }

  void Move(MapPoint& point) const {
    if (point.position.allFinite()) point.position = Moved(point.position.cast<double>()).cast<float>();
    point.normal = Turned(point.normal, 1);
    point.min_distance = Scaled(point.min_distance);
    point.max_distance = Scaled(point.max_distance);
  }

 private:
  float Scaled(float length) const { return std::isfinite(length) ? static_cast<float>(length * scale_) : length; }
  void Scale(Rigid3f& transform) const {
    for (float& length : transform.translation) length = Scaled(length);
  }

  Eigen::Vector3d Moved(const Eigen::Vector3d& x) const { return scale_ * (matrix_ * x) + translation_; }

  // Zero is what a direction is where there is none; it stays so, sign bits included.
  Eigen::Vector3f Turned(const Eigen::Vector3f& direction, double scale) const {
    if (!direction.allFinite() || direction.isZero(0)) return direction;
    return (scale * (matrix_ * direction.cast<double>())).cast<float>();
  }

  // Camera coordinates scale with the world, so that pixels stay: s x_c = s (R_cw x + t_cw) for x = R^T (x' - t) / s.
  Rigid3f CameraFromTarget(const Rigid3f& camera_from_source) const {
    if (!detail::IsFinite(camera_from_source)) return camera_from_source;
    const Eigen::Quaterniond recorded = camera_from_source.rotation.cast<double>();
    const Eigen::Quaterniond rotation = recorded * rotation_.conjugate();
    const Eigen::Vector3d translation =
        scale_ * camera_from_source.translation.cast<double>() - rotation.normalized() * translation_;
    return {turns_ ? Quaternionf(rotation.cast<float>()) : camera_from_source.rotation, translation.cast<float>()};
  }

  // The camera's centre moves; the lever arm from it to the IMU is metal and only turns.
  Eigen::Vector3f BodyPosition(const KeyFrame& keyframe) const {
    const Rigid3f& pose = keyframe.camera_from_world;
    if (!keyframe.imu_calibration.is_set || !keyframe.body_position.allFinite() || !detail::IsFinite(pose))
      return keyframe.body_position;
    const Eigen::Quaterniond world_from_camera = pose.rotation.cast<double>().normalized().conjugate();
    const Eigen::Vector3d center = -(world_from_camera * pose.translation.cast<double>());
    const Eigen::Vector3d arm = keyframe.body_position.cast<double>() - center;
    return (Moved(center) + matrix_ * arm).cast<float>();
  }

  void Scale(KeyFrame& keyframe) const {
    Scale(keyframe.camera_from_parent);
    Scale(keyframe.left_from_right);
    Intrinsics& intrinsics = keyframe.intrinsics;
    for (float* length :
         {&intrinsics.baseline_fx, &intrinsics.baseline, &intrinsics.depth_threshold, &keyframe.half_baseline})
      *length = Scaled(*length);
    for (float& depth : keyframe.features.depth)
      if (depth > 0) depth = Scaled(depth);
    if (IsMergeScale(keyframe.merge_scale)) keyframe.merge_scale = static_cast<float>(keyframe.merge_scale / scale_);
  }

  const double scale_;
  const bool turns_;
  const Eigen::Quaterniond rotation_;
  const Eigen::Matrix3d matrix_;
  const Eigen::Vector3d translation_;
};

double DegreesFromZ(const Eigen::Vector3d& direction) {
  return std::acos(std::clamp(direction.normalized().z(), -1.0, 1.0)) * 180 / std::numbers::pi;
}

// The largest coordinate that a camera or point has after the move.
double LargestCoordinate(const Map& map, const Similarity3d& transform) {
  double largest = 0;
  const auto add = [&](const Eigen::Vector3f& position) {
    if (position.allFinite()) largest = std::max(largest, (transform * position.cast<double>()).cwiseAbs().maxCoeff());
  };
  for (const KeyFrame& keyframe : map.keyframes) add(keyframe.camera_from_world.Normalized().Center());
  for (const MapPoint& point : map.points) add(point.position);
  return largest;
}

}  // namespace

void RequireTransform(const Similarity3d& transform) {
  if (!transform.rotation.coeffs().allFinite() || !transform.translation.allFinite() || !std::isfinite(transform.scale))
    throw Error(ErrorKind::kUsage, "the transform holds NaN or infinity");
  if (!(transform.rotation.norm() > 1e-6))
    throw Error(ErrorKind::kUsage, "the quaternion of the transform is zero; it must be of length 1");
  if (!(transform.scale > 0))
    throw Error(ErrorKind::kUsage, detail::Concat("the scale of the transform must be above 0, not ", transform.scale));
  constexpr double kLargest = 1e30;  // far below what a float holds, so that products of two stay finite
  if (transform.scale > kLargest || transform.scale < 1 / kLargest ||
      transform.translation.cwiseAbs().maxCoeff() > kLargest)
    throw Error(ErrorKind::kUsage, "the transform is too large for the single precision of a map");
}

void TransformMap(Map& map, const Similarity3d& target_from_source, int threads) {
  RequireTransform(target_from_source);
  if (IsIdentity(target_from_source)) return;
  const Mover mover(target_from_source);
  detail::ParallelFor(map.keyframes.size(), kKeyFramesPerBlock, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) mover.Move(map.keyframes[row]);
  });
  detail::ParallelFor(map.points.size(), kPointsPerBlock, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) mover.Move(map.points[row]);
  });
  TransformLandmarks(map.landmarks, target_from_source);
}

std::vector<std::string> TransformWarnings(const Map& map, const Similarity3d& target_from_source) {
  std::vector<std::string> warnings;
  if (map.imu_initialized) {
    constexpr double kTiltDegrees = 1;
    const Eigen::Vector3d up = -GravityByInertia(map).value_or(-Eigen::Vector3d::UnitZ());
    const double before = DegreesFromZ(up), after = DegreesFromZ(target_from_source.rotation * up);
    if (after > std::max(before, kTiltDegrees))
      warnings.push_back(detail::Concat("gravity is tilted: it pointed ", detail::Fixed(before, 1),
                                        " degrees off -z and will point ", detail::Fixed(after, 1),
                                        " degrees off it, but ORB-SLAM3 takes it along -z in a map with IMU"));
    if (target_from_source.scale != 1)
      warnings.push_back(
          detail::Concat("the scale changes by ", target_from_source.scale,
                         " in a map whose unit is the metre of its IMU: what the IMU measured stays as it is, which is "
                         "right only where this corrects an error of scale"));
  } else if (target_from_source.scale != 1 && detail::HasStereo(map)) {
    warnings.push_back(detail::Concat(
        "the scale changes by ", target_from_source.scale,
        " in a map whose unit is the baseline of its stereo or depth camera: the baseline changes along, "
        "and a session that goes on with the map needs it so in its settings"));
  }
  return warnings;
}

std::optional<std::string> CoarseningLoss(const Map& map, const Similarity3d& target_from_source) {
  constexpr double kCoarseStep = 1e-3;
  constexpr double kEpsilon = std::numeric_limits<float>::epsilon();
  const double largest = LargestCoordinate(map, target_from_source);
  const double step = largest * kEpsilon;
  if (step <= kCoarseStep || LargestCoordinate(map, {}) * kEpsilon >= step) return std::nullopt;
  return detail::Concat("coordinates reach ", detail::Fixed(largest, 0), ", where single precision has steps of ",
                        detail::Digits(step, 1),
                        ": positions are rounded to these; take an offset away from the reference, or choose an origin "
                        "nearby for fixes");
}

}  // namespace slamdb
