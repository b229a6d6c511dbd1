// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/sanitize.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

namespace slamdb {
namespace {

// Sets `field` to `value` and tells whether its bits changed.
template <class T>
bool Reset(T& field, const T& value) {
  if (std::memcmp(&field, &value, sizeof(T)) == 0) return false;
  field = value;
  return true;
}
template <class Derived, class Other>
bool ResetMatrix(Eigen::PlainObjectBase<Derived>& field, const Eigen::MatrixBase<Other>& value) {
  const Derived reset = value;
  if (std::memcmp(field.data(), reset.data(), sizeof(float) * static_cast<std::size_t>(reset.size())) == 0)
    return false;
  field.derived() = reset;
  return true;
}

bool ResetPreintegration(ImuPreintegration& imu) {
  bool changed = Reset(imu.duration, 0.0F);
  changed |= ResetMatrix(imu.covariance, Matrix15f::Zero());
  changed |= ResetMatrix(imu.information, Matrix15f::Zero());
  changed |= ResetMatrix(imu.rotation, Eigen::Matrix3f::Identity());
  for (auto* jacobian : {&imu.rotation_by_gyro, &imu.velocity_by_gyro, &imu.velocity_by_acc, &imu.position_by_gyro,
                         &imu.position_by_acc})
    changed |= ResetMatrix(*jacobian, Eigen::Matrix3f::Zero());
  for (auto* vector : {&imu.velocity, &imu.position, &imu.mean_acceleration, &imu.mean_angular_velocity})
    changed |= ResetMatrix(*vector, Eigen::Vector3f::Zero());
  for (auto* vector : {&imu.noise, &imu.walk_noise, &imu.bias_change})
    changed |= ResetMatrix(*vector, Vector6f::Zero());
  return changed;
}

struct Counts {
  std::size_t merge_scales = 0, preintegrations = 0, calibrations = 0, body_positions = 0, references = 0, flags = 0;
};

void CountFlag(Flag& flag, Counts& counts) {
  if (flag.recorded <= 1) return;
  flag = true;
  ++counts.flags;
}

void SanitizeKeyFrame(KeyFrame& keyframe, bool inertial_map, Counts& counts) {
  // A real merge scale is near 1; uninitialised memory is a denormal, huge, or no number.
  const float scale = std::abs(keyframe.merge_scale);
  if (!(scale >= 1e-3F && scale <= 1e3F)) counts.merge_scales += Reset(keyframe.merge_scale, 0.0F);
  if (!inertial_map && !keyframe.imu_calibration.is_set) {
    counts.preintegrations += ResetPreintegration(keyframe.preintegration);
    counts.body_positions += ResetMatrix(keyframe.body_position, Eigen::Vector3f::Zero());
  }
  if (!keyframe.imu_calibration.is_set) {
    const bool noise = ResetMatrix(keyframe.imu_calibration.noise, Vector6f::Zero());
    counts.calibrations += ResetMatrix(keyframe.imu_calibration.walk_noise, Vector6f::Zero()) || noise;
  }
  for (Flag* flag : {&keyframe.first_connection, &keyframe.not_erase, &keyframe.to_be_erased, &keyframe.bad,
                     &keyframe.imu_initialized, &keyframe.has_velocity, &keyframe.imu_calibration.is_set})
    CountFlag(*flag, counts);
}

void SanitizeMap(Map& map, Counts& counts) {
  std::unordered_set<KeyFrameId> ids;
  for (KeyFrame& keyframe : map.keyframes) {
    ids.insert(keyframe.id);
    SanitizeKeyFrame(keyframe, map.inertial, counts);
  }
  for (MapPoint& point : map.points) {
    CountFlag(point.bad, counts);
    if (ids.contains(point.reference)) continue;
    const auto observer = std::find_if(point.observations.begin(), point.observations.end(),
                                       [&](const Observation& seen) { return ids.contains(seen.keyframe); });
    const KeyFrameId reference = observer == point.observations.end() ? KeyFrameId() : observer->keyframe;
    counts.references += Reset(point.reference, reference);
  }
  for (Flag* flag : {&map.imu_initialized, &map.inertial, &map.imu_ba1, &map.imu_ba2}) CountFlag(*flag, counts);
}

}  // namespace

std::vector<std::string> SanitizeForOrbslam3(Atlas& atlas) {
  std::vector<std::string> changes;
  const auto tell = [&](std::size_t count, const char* what) {
    if (count > 0) changes.push_back(std::to_string(count) + " " + what);
  };
  tell(atlas.repeated_maps.size(), "map pointers that were stored twice or null dropped");
  atlas.repeated_maps.clear();
  std::size_t list_entries = atlas.repeated_cameras.size();
  atlas.repeated_cameras.clear();
  Counts counts;
  for (Map& map : atlas.maps) {
    list_entries += map.repeated_keyframes.size() + map.repeated_points.size();
    map.repeated_keyframes.clear();
    map.repeated_points.clear();
    SanitizeMap(map, counts);
  }
  tell(list_entries, "list entries that were stored twice or null dropped");
  tell(std::erase_if(atlas.maps, [](const Map& map) { return map.keyframes.empty(); }), "empty maps dropped");
  tell(counts.merge_scales, "uninitialised merge scales (mfScale) set to 0");
  tell(counts.preintegrations, "uninitialised preintegrations (mBackupImuPreintegrated) set to 0");
  tell(counts.body_positions, "uninitialised body positions (mOwb) set to 0");
  tell(counts.calibrations, "uninitialised IMU noise values (mImuCalib) set to 0");
  tell(counts.references, "reference keyframes outside the map (mBackupRefKFId) set to an observer");
  tell(counts.flags, "flags that were neither 0 nor 1 set to 1");
  return changes;
}

}  // namespace slamdb
