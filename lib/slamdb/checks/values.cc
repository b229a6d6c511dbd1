// SPDX-License-Identifier: BSD-3-Clause
// Values: numbers that are finite, unit where they must be, and agree with each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/detail/observed.h"

namespace slamdb::detail {
namespace {

constexpr float kUnitTolerance = 1e-3F;         // of normals
constexpr double kLargeReprojectionPixels = 5;  // real maps have a median of about 1

// visit(name, transform) for the rigid transforms of a keyframe, all of which ORB-SLAM3 constructs on load.
template <class Visit>
void ForEachTransform(const KeyFrame& keyframe, const Visit& visit) {
  visit("pose", keyframe.camera_from_world);
  visit("pose relative to the parent", keyframe.camera_from_parent);
  visit("left camera from right camera", keyframe.left_from_right);
  visit("camera from body", keyframe.imu_calibration.camera_from_body);
  visit("body from camera", keyframe.imu_calibration.body_from_camera);
}

// The third row of camera_from_world: depth = axis . x + offset.
struct DepthAxis {
  Eigen::Vector3f axis;
  float offset;
  bool pinhole;
};

std::vector<DepthAxis> DepthAxes(const Subject& subject, const Map& map) {
  std::vector<DepthAxis> axes;
  axes.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) {
    const Camera* camera = subject.index.FindCamera(keyframe.camera);
    const Rigid3f& pose = keyframe.camera_from_world;
    axes.push_back({pose.rotation.normalized().toRotationMatrix().row(2).transpose(), pose.translation.z(),
                    camera != nullptr && camera->model == CameraModel::kPinhole});
  }
  return axes;
}

template <class Visit>
void ForEachFlag(Atlas& atlas, const Visit& visit) {
  for (Map& map : atlas.maps) {
    for (Flag* flag : {&map.imu_initialized, &map.inertial, &map.imu_ba1, &map.imu_ba2}) visit(*flag);
    for (KeyFrame& keyframe : map.keyframes)
      for (Flag* flag : {&keyframe.first_connection, &keyframe.not_erase, &keyframe.to_be_erased, &keyframe.bad,
                         &keyframe.imu_initialized, &keyframe.has_velocity, &keyframe.imu_calibration.is_set})
        visit(*flag);
    for (MapPoint& point : map.points) visit(point.bad);
  }
}

bool IsSoundNormal(const Eigen::Vector3f& normal) {
  const float length = normal.norm();
  return length > 0 && length <= 1 + kUnitTolerance;
}

bool HasSoundRange(const MapPoint& point) {
  return point.min_distance > 0 && point.min_distance <= point.max_distance && std::isfinite(point.max_distance);
}

bool SpansPyramid(const MapPoint& point, const ScalePyramid& pyramid) {
  const float range = pyramid.factors.back();
  return std::abs(point.max_distance / point.min_distance - range) <= 0.01F * range;
}

// Applies restore(point, find keyframe by id) to every point that is not bad; it tells whether it changed it.
template <class Restore>
std::size_t RestoreInPoints(Atlas& atlas, const Restore& restore) {
  const AtlasIndex index(atlas);
  std::size_t restored = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const auto find = [&](KeyFrameId id) { return index.FindKeyFrame(row, id); };
    for (MapPoint& point : atlas.maps[row].points)
      if (!point.bad) restored += restore(point, find);
  }
  return restored;
}

bool IsGarbage(Flag flag) { return flag.recorded > 1; }

}  // namespace

void CheckPoseFinite(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachTransform(keyframe, [&](const char* name, const Rigid3f& transform) {
      if (!IsFinite(transform)) findings.Add(PlaceOf(map, keyframe), "the ", name, " holds NaN or infinity");
    });
  });
}

void CheckRotationUnit(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachTransform(keyframe, [&](const char* name, const Rigid3f& transform) {
      if (IsFinite(transform) && !IsUnit(transform.rotation))
        findings.Add(PlaceOf(map, keyframe), "the quaternion of the ", name, " has norm ", transform.rotation.norm());
    });
  });
}

// ORB-SLAM3 sets the pose relative to the parent when it culls the keyframe, and reads it of culled ones only.
std::size_t NormalizeRotations(Atlas& atlas) {
  std::size_t normalized = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      if (keyframe.bad) continue;
      if (Rigid3f& relative = keyframe.camera_from_parent; IsFinite(relative) && !IsRotation(relative.rotation)) {
        relative.rotation.setIdentity();
        ++normalized;
      }
      for (Rigid3f* transform :
           {&keyframe.camera_from_world, &keyframe.camera_from_parent, &keyframe.left_from_right,
            &keyframe.imu_calibration.camera_from_body, &keyframe.imu_calibration.body_from_camera}) {
        Quaternionf& rotation = transform->rotation;
        if (!IsPose(*transform) || IsUnit(rotation)) continue;
        rotation.normalize();
        ++normalized;
      }
    }
  return normalized;
}

void CheckPointFinite(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (!point.position.allFinite()) findings.Add(PlaceOf(map, point), "its position holds NaN or infinity");
    if (!point.normal.allFinite()) findings.Add(PlaceOf(map, point), "its normal holds NaN or infinity");
  });
}

// A point that is nowhere is of no use; the direction it is seen from can be found again.
std::size_t DropInfinitePoints(Atlas& atlas) {
  const std::size_t dropped =
      DropPoints(atlas, [](const MapPoint& point) { return !point.bad && !point.position.allFinite(); });
  return dropped + RestoreNormals(atlas);
}

void CheckPointNormal(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (point.normal.allFinite() && !IsSoundNormal(point.normal))
      findings.Add(PlaceOf(map, point), "its normal has length ", point.normal.norm(), ", as no mean of unit vectors");
  });
}

std::size_t RestoreNormals(Atlas& atlas) {
  return RestoreInPoints(atlas, [](MapPoint& point, const auto& find) {
    if (IsSoundNormal(point.normal) || !point.position.allFinite()) return false;
    const std::optional<Eigen::Vector3f> normal = ObservedNormal(point, find);
    if (!normal || !IsSoundNormal(*normal)) return false;
    point.normal = *normal;
    return true;
  });
}

void CheckPointDescriptor(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (!point.has_descriptor() && !point.has_other_descriptor())
      findings.Add(PlaceOf(map, point), "has no descriptor");
  });
}

// As ORB-SLAM3 chooses it among those of the observers (MapPoint::ComputeDistinctiveDescriptors).
std::size_t RestoreDescriptors(Atlas& atlas) {
  return RestoreInPoints(atlas, [](MapPoint& point, const auto& find) {
    if (point.has_descriptor() || point.has_other_descriptor()) return false;
    const std::vector<Descriptor> seen = ObservedDescriptors(point, find);
    if (seen.empty()) return false;
    point.descriptor = seen[MostDistinctiveDescriptor(seen)];
    point.descriptor_form = MatrixForm::kUsual;
    return true;
  });
}

void CheckDistanceRange(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (!HasSoundRange(point))
      findings.Add(PlaceOf(map, point), "its distance range is none: ", point.min_distance, " to ", point.max_distance);
  });
}

// From the reference keyframe, as ORB-SLAM3 does it.
std::size_t RestoreDistanceRanges(Atlas& atlas) {
  return RestoreInPoints(atlas, [](MapPoint& point, const auto& find) {
    const KeyFrame* reference = find(point.reference);
    if (reference == nullptr || reference->pyramid.factors.empty()) return false;
    if (HasSoundRange(point) && SpansPyramid(point, reference->pyramid)) return false;
    const DistanceRange range = ObservedRange(point, *reference);
    MapPoint restored = point;
    restored.min_distance = range.min;
    restored.max_distance = range.max;
    if (!HasSoundRange(restored) || !SpansPyramid(restored, reference->pyramid)) return false;
    point = std::move(restored);
    return true;
  });
}

void CheckDistanceRatio(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    const KeyFrame* reference = subject.index.FindKeyFrame(row, point.reference);
    if (!HasSoundRange(point) || reference == nullptr || reference->pyramid.factors.empty()) return;
    if (!SpansPyramid(point, reference->pyramid))
      findings.Add(PlaceOf(map, point), "its farthest distance is ", point.max_distance / point.min_distance,
                   " times its nearest, but the pyramid of ", point.reference, " spans ",
                   reference->pyramid.factors.back());
  });
}

void CheckPointInFront(const Subject& subject, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Map& map = subject.atlas.maps[row];
    const std::vector<DepthAxis> axes = DepthAxes(subject, map);
    for (const MapPoint& point : map.points) {
      if (point.bad) continue;
      for (const Observation& observation : point.observations) {
        const std::uint32_t observer = subject.index.KeyFrameRow(row, observation.keyframe);
        if (observer == kNoRow || observation.left < 0 || !axes[observer].pinhole) continue;
        if (const float depth = axes[observer].axis.dot(point.position) + axes[observer].offset; depth <= 0)
          findings.Add(PlaceOf(map, point), "is ", -depth, " behind ", observation.keyframe, ", which observes it");
      }
    }
  }
}

void CheckReprojection(const Subject& subject, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Distribution& error = subject.statistics.maps[row].reprojection_error;
    if (error.median > kLargeReprojectionPixels)
      findings.Add(PlaceOf(subject.atlas.maps[row]), "half of ", error.count, " observations are more than ",
                   error.median, " px off their keypoints");
  }
}

void CheckTimestampFinite(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (!std::isfinite(keyframe.timestamp))
      findings.Add(PlaceOf(map, keyframe), "its timestamp is ", keyframe.timestamp);
  });
}

void CheckFlagByte(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    const std::array map_flags{map.imu_initialized, map.inertial, map.imu_ba1, map.imu_ba2};
    if (std::ranges::any_of(map_flags, IsGarbage)) findings.Add(PlaceOf(map), "a flag is neither 0 nor 1");
    for (const KeyFrame& keyframe : map.keyframes) {
      const std::array flags{
          keyframe.first_connection, keyframe.not_erase,    keyframe.to_be_erased,          keyframe.bad,
          keyframe.imu_initialized,  keyframe.has_velocity, keyframe.imu_calibration.is_set};
      if (std::ranges::any_of(flags, IsGarbage)) findings.Add(PlaceOf(map, keyframe), "a flag is neither 0 nor 1");
    }
    for (const MapPoint& point : map.points)
      if (IsGarbage(point.bad)) findings.Add(PlaceOf(map, point), "a flag is neither 0 nor 1");
  }
}

std::size_t NormalizeFlags(Atlas& atlas) {
  std::size_t changed = 0;
  ForEachFlag(atlas, [&](Flag& flag) {
    if (!IsGarbage(flag)) return;
    flag = true;
    ++changed;
  });
  return changed;
}

}  // namespace slamdb::detail
