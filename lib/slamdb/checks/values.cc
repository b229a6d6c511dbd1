// SPDX-License-Identifier: BSD-3-Clause
// Values: numbers that are finite, unit where they must be, and agree with each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "slamdb/checks/catalogue.h"
#include "slamdb/checks/visit.h"
#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

constexpr float kUnitTolerance = 1e-3F;         // files hold unit quaternions to 1e-6
constexpr double kLargeReprojectionPixels = 5;  // real maps have a median of about 1

bool IsFinite(const Rigid3f& transform) {
  return transform.rotation.coeffs().allFinite() && transform.translation.allFinite();
}

bool IsUnit(const Quaternionf& rotation) { return std::abs(rotation.norm() - 1) <= kUnitTolerance; }

// visit(name, transform) for the rigid transforms of a keyframe, all of which ORB-SLAM3 constructs on load.
template <class Visit>
void ForEachTransform(const KeyFrame& keyframe, const Visit& visit) {
  visit("pose", keyframe.camera_from_world);
  visit("pose relative to the parent", keyframe.camera_from_parent);
  visit("left camera from right camera", keyframe.left_from_right);
  visit("camera from body", keyframe.imu_calibration.camera_from_body);
  visit("body from camera", keyframe.imu_calibration.body_from_camera);
}

bool Near(float a, float b) { return std::abs(a - b) <= 1e-3F * std::max(1.0F, std::abs(b)); }

std::size_t ParameterCount(CameraModel model) { return model == CameraModel::kKannalaBrandt8 ? 8 : 4; }

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

void CheckPointFinite(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (!point.position.allFinite()) findings.Add(PlaceOf(map, point), "its position holds NaN or infinity");
    if (!point.normal.allFinite()) findings.Add(PlaceOf(map, point), "its normal holds NaN or infinity");
  });
}

void CheckPointNormal(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    const float length = point.normal.norm();
    if (length > 1 + kUnitTolerance || length == 0)
      findings.Add(PlaceOf(map, point), "its normal, a mean of unit vectors, has length ", length);
  });
}

void CheckPointDescriptor(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (!point.has_descriptor()) findings.Add(PlaceOf(map, point), "has no descriptor");
  });
}

void CheckDistanceRange(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    const float min = point.min_distance, max = point.max_distance;
    if (!(min > 0 && min <= max && std::isfinite(max)))
      findings.Add(PlaceOf(map, point), "is to be seen from ", min, " to ", max, " away");
  });
}

void CheckDistanceRatio(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    const float min = point.min_distance, max = point.max_distance;
    if (!(min > 0 && min <= max && std::isfinite(max))) return;
    const KeyFrame* reference = subject.index.FindKeyFrame(row, point.reference);
    if (reference == nullptr || reference->pyramid.factors.empty()) return;
    const float range = reference->pyramid.factors.back();
    if (!(std::abs(max / min - range) <= 0.01F * range))
      findings.Add(PlaceOf(map, point), "its farthest distance is ", max / min,
                   " times its nearest, but the pyramid of ", point.reference, " spans ", range);
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

// Keyframes of one origin map come from one run of the system; what merging brought together may overlap in time.
void CheckTimestampOrder(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    std::vector<const KeyFrame*> order;
    for (const KeyFrame& keyframe : map.keyframes)
      if (!keyframe.bad && std::isfinite(keyframe.timestamp)) order.push_back(&keyframe);
    std::ranges::stable_sort(order, [](const KeyFrame* a, const KeyFrame* b) {
      return std::pair(a->origin_map, a->id) < std::pair(b->origin_map, b->id);
    });
    for (std::size_t i = 1; i < order.size(); ++i) {
      const KeyFrame &before = *order[i - 1], &after = *order[i];
      if (before.origin_map == after.origin_map && before.id != after.id && after.timestamp <= before.timestamp)
        findings.Add(PlaceOf(map, after), "was taken ", before.timestamp - after.timestamp, " s before ", before.id);
    }
  }
}

void CheckCameraParameters(const Subject& subject, Findings& findings) {
  for (const Camera& camera : subject.atlas.cameras) {
    const Place place{.camera = camera.id};
    const std::size_t expected = ParameterCount(camera.model);
    if (camera.parameters.size() != expected)
      findings.Add(place, "has ", camera.parameters.size(), " parameters instead of ", expected);
    else if (!std::ranges::all_of(camera.parameters, [](float value) { return std::isfinite(value); }))
      findings.Add(place, "its parameters hold NaN or infinity");
    else if (!(camera.parameters[0] > 0 && camera.parameters[1] > 0))
      findings.Add(place, "its focal lengths are ", camera.parameters[0], " and ", camera.parameters[1]);
  }
}

void CheckCameraType(const Subject& subject, Findings& findings) {
  for (const Camera& camera : subject.atlas.cameras)
    if (camera.recorded_type != static_cast<std::uint32_t>(camera.model))
      findings.Add(Place{.camera = camera.id}, "has type ", camera.recorded_type, ", but is stored as ",
                   camera.model == CameraModel::kPinhole ? "Pinhole (0)" : "KannalaBrandt8 (1)");
}

std::size_t SetCameraTypes(Atlas& atlas) {
  std::size_t changed = 0;
  for (Camera& camera : atlas.cameras) {
    if (camera.recorded_type == static_cast<std::uint32_t>(camera.model)) continue;
    camera.recorded_type = static_cast<std::uint32_t>(camera.model);
    ++changed;
  }
  return changed;
}

void CheckIntrinsicsPositive(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Intrinsics& k = keyframe.intrinsics;
    const bool finite = std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy);
    if (!finite || !(k.fx > 0 && k.fy > 0))
      findings.Add(PlaceOf(map, keyframe), "fx, fy, cx, cy are ", k.fx, ", ", k.fy, ", ", k.cx, ", ", k.cy);
  });
}

void CheckIntrinsicsAgree(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Intrinsics& k = keyframe.intrinsics;
    if (!(k.fx > 0 && k.fy > 0)) return;  // the business of intrinsics-positive
    const auto expect = [&](bool agrees, const char* what) {
      if (!agrees) findings.Add(PlaceOf(map, keyframe), what);
    };
    const Eigen::Matrix3f& matrix = keyframe.calibration_matrix;
    expect(Near(k.inverse_fx * k.fx, 1) && Near(k.inverse_fy * k.fy, 1), "invfx and invfy are not 1/fx and 1/fy");
    expect(Near(matrix(0, 0), k.fx) && Near(matrix(1, 1), k.fy) && Near(matrix(0, 2), k.cx) && Near(matrix(1, 2), k.cy),
           "the calibration matrix does not hold fx, fy, cx, cy");
    expect(Near(k.baseline * k.fx, k.baseline_fx), "the baseline mb is not mbf / fx");
    expect(Near(2 * keyframe.half_baseline, k.baseline), "the half baseline is not half the baseline");
    const Camera* camera = subject.index.FindCamera(keyframe.camera);
    if (camera == nullptr || camera->parameters.size() != ParameterCount(camera->model)) return;
    const std::vector<float>& p = camera->parameters;
    expect(Near(p[0], k.fx) && Near(p[1], k.fy) && Near(p[2], k.cx) && Near(p[3], k.cy),
           "fx, fy, cx, cy are not its camera's");
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

}  // namespace slamdb
