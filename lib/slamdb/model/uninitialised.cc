// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/uninitialised.h"

namespace slamdb::detail {
namespace {

// A real merge scale is near 1; uninitialised memory is a denormal, huge, or no number.
constexpr float kLeastMergeScale = 1e-3F, kLargestMergeScale = 1e3F;

template <class Matrix>
bool IsZero(const Matrix& matrix) {
  return (matrix.array() == 0).all();
}

bool IsIdle(const ImuPreintegration& imu) {
  return imu.duration == 0 && IsZero(imu.covariance) && IsZero(imu.information) && IsZero(imu.noise) &&
         IsZero(imu.walk_noise) && (IsZero(imu.rotation) || imu.rotation.isIdentity(0)) && IsZero(imu.velocity) &&
         IsZero(imu.position) && IsZero(imu.rotation_by_gyro) && IsZero(imu.velocity_by_gyro) &&
         IsZero(imu.velocity_by_acc) && IsZero(imu.position_by_gyro) && IsZero(imu.position_by_acc) &&
         IsZero(imu.mean_acceleration) && IsZero(imu.mean_angular_velocity) && IsZero(imu.bias_change);
}

ImuPreintegration IdleWithBiasesOf(const ImuPreintegration& imu) {
  ImuPreintegration idle;
  idle.rotation.setIdentity();
  idle.bias = imu.bias;
  idle.updated_bias = imu.updated_bias;
  return idle;
}

bool HasNoImu(const Map& map, const KeyFrame& keyframe) { return !map.inertial && !keyframe.imu_calibration.is_set; }

}  // namespace

bool HasWildMergeScale(const KeyFrame& keyframe) {
  const float scale = keyframe.merge_scale;
  return scale != 0 && !(scale >= kLeastMergeScale && scale <= kLargestMergeScale);
}

bool HasWildPreintegration(const Map& map, const KeyFrame& keyframe) {
  return HasNoImu(map, keyframe) && keyframe.preintegration.measurements.empty() && !IsIdle(keyframe.preintegration);
}

bool HasWildBodyPosition(const Map& map, const KeyFrame& keyframe) {
  return HasNoImu(map, keyframe) && !IsZero(keyframe.body_position);
}

bool HasWildNoise(const KeyFrame& keyframe) {
  const ImuCalibration& calibration = keyframe.imu_calibration;
  return !calibration.is_set && !(IsZero(calibration.noise) && IsZero(calibration.walk_noise));
}

UninitialisedCounts ResetUninitialised(Map& map) {
  UninitialisedCounts counts;
  for (KeyFrame& keyframe : map.keyframes) {
    if (HasWildMergeScale(keyframe)) {
      keyframe.merge_scale = 0;
      ++counts.merge_scales;
    }
    if (HasWildPreintegration(map, keyframe)) {
      keyframe.preintegration = IdleWithBiasesOf(keyframe.preintegration);
      ++counts.preintegrations;
    }
    if (HasWildBodyPosition(map, keyframe)) {
      keyframe.body_position.setZero();
      ++counts.body_positions;
    }
    if (HasWildNoise(keyframe)) {
      keyframe.imu_calibration.noise.setZero();
      keyframe.imu_calibration.walk_noise.setZero();
      ++counts.noises;
    }
  }
  return counts;
}

}  // namespace slamdb::detail
