// SPDX-License-Identifier: BSD-3-Clause
// Inertial maps, and what is uninitialised in maps that are not.
#include <algorithm>
#include <cmath>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/detail/uninitialised.h"
#include "slamdb/model/preintegration.h"

namespace slamdb::detail {
namespace {

constexpr float kTransformTolerance = 1e-3F;

bool IsIntegrated(const ImuPreintegration& imu) {
  return imu.duration > 0 && std::isfinite(imu.duration) && imu.covariance.allFinite() && imu.rotation.allFinite() &&
         imu.velocity.allFinite() && imu.position.allFinite();
}

bool IsFinite(const ImuBias& bias) { return bias.accelerometer.allFinite() && bias.gyroscope.allFinite(); }

// The keyframes of maps with an initialised IMU.
template <class Visit>
void ForEachInertialKeyFrame(const Subject& subject, const Visit& visit) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    if (map.imu_initialized) visit(row, map, keyframe);
  });
}

bool IsFinite(const ImuPreintegration& imu) {
  return std::isfinite(imu.duration) && imu.covariance.allFinite() && imu.information.allFinite() &&
         imu.noise.allFinite() && imu.walk_noise.allFinite() && imu.rotation.allFinite() && imu.velocity.allFinite() &&
         imu.position.allFinite() && imu.rotation_by_gyro.allFinite() && imu.velocity_by_gyro.allFinite() &&
         imu.velocity_by_acc.allFinite() && imu.position_by_gyro.allFinite() && imu.position_by_acc.allFinite() &&
         imu.mean_acceleration.allFinite() && imu.mean_angular_velocity.allFinite() && imu.bias_change.allFinite();
}

}  // namespace

void CheckImuChain(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    if (!map.inertial) return;
    const KeyFrame* previous = subject.index.FindKeyFrame(row, keyframe.previous);
    const KeyFrame* next = subject.index.FindKeyFrame(row, keyframe.next);
    if (previous != nullptr && previous != &keyframe) {
      if (previous->next != keyframe.id)
        findings.Add(PlaceOf(map, keyframe), "previous ", keyframe.previous, " is followed by ", previous->next,
                     " instead of it");
      else if (!(previous->timestamp < keyframe.timestamp))
        findings.Add(PlaceOf(map, keyframe), "previous ", keyframe.previous, " was not taken before it");
    }
    if (next != nullptr && next != &keyframe && next->previous != keyframe.id)
      findings.Add(PlaceOf(map, keyframe), "next ", keyframe.next, " comes after ", next->previous, " instead of it");
  });
}

void CheckImuCalibration(const Subject& subject, Findings& findings) {
  ForEachInertialKeyFrame(subject, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (!keyframe.imu_calibration.is_set)
      findings.Add(PlaceOf(map, keyframe), "has no IMU calibration in a map whose IMU is initialised");
  });
}

void CheckImuCalibrationInverse(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const ImuCalibration& calibration = keyframe.imu_calibration;
    if (!calibration.is_set) return;
    const Rigid3f round_trip = calibration.camera_from_body.Normalized() * calibration.body_from_camera.Normalized();
    const bool inverse =
        round_trip.translation.norm() <= kTransformTolerance && round_trip.rotation.vec().norm() <= kTransformTolerance;
    if (!inverse) findings.Add(PlaceOf(map, keyframe), "body from camera is not the inverse of camera from body");
  });
}

void CheckImuPreintegration(const Subject& subject, Findings& findings) {
  ForEachInertialKeyFrame(subject, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (keyframe.previous && !IsIntegrated(keyframe.preintegration))
      findings.Add(PlaceOf(map, keyframe), "has no valid preintegration since ", keyframe.previous, ": it lasts ",
                   keyframe.preintegration.duration, " s");
  });
}

void CheckImuDuration(const Subject& subject, Findings& findings) {
  ForEachInertialKeyFrame(subject, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const KeyFrame* previous = subject.index.FindKeyFrame(row, keyframe.previous);
    if (previous == nullptr || !IsIntegrated(keyframe.preintegration)) return;
    const double apart = keyframe.timestamp - previous->timestamp;
    if (apart > 0 && std::abs(keyframe.preintegration.duration - apart) > kPreintegrationTolerance)
      findings.Add(PlaceOf(map, keyframe), "its preintegration lasts ", keyframe.preintegration.duration,
                   " s, but it was taken ", apart, " s after ", keyframe.previous);
  });
}

void CheckImuMotion(const Subject& subject, Findings& findings) {
  ForEachInertialKeyFrame(subject, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (!keyframe.velocity.allFinite()) findings.Add(PlaceOf(map, keyframe), "its velocity holds NaN or infinity");
    if (!IsFinite(keyframe.imu_bias)) findings.Add(PlaceOf(map, keyframe), "its IMU bias holds NaN or infinity");
  });
}

void CheckImuStages(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    if (map.imu_initialized && !map.inertial)
      findings.Add(PlaceOf(map), "its IMU is initialised, but it is not inertial");
    if ((map.imu_ba1 || map.imu_ba2) && !map.imu_initialized)
      findings.Add(PlaceOf(map), "inertial bundle adjustment is done, but its IMU is not initialised");
  }
}

// A stage without the one before it is done again.
std::size_t ResetImuStages(Atlas& atlas) {
  std::size_t reset = 0;
  for (Map& map : atlas.maps) {
    const bool initialized = map.inertial && map.imu_initialized;
    for (Flag* flag : {&map.imu_initialized, &map.imu_ba1, &map.imu_ba2}) {
      if (initialized || !*flag) continue;
      *flag = false;
      ++reset;
    }
  }
  return reset;
}

void CheckUninitialised(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    const auto report = [&](const char* field, const auto& is_wild) {
      const auto count = std::ranges::count_if(map.keyframes, is_wild);
      if (count > 0) findings.Add(PlaceOf(map), field, " is uninitialised memory in ", count, " keyframes");
    };
    report("the merge scale (mfScale)", HasWildMergeScale);
    report("the preintegration (mBackupImuPreintegrated) without IMU",
           [&](const KeyFrame& keyframe) { return HasWildPreintegration(map, keyframe); });
    report("the body position (mOwb) without IMU",
           [&](const KeyFrame& keyframe) { return HasWildBodyPosition(map, keyframe); });
    report("the noise of an unset IMU calibration (mImuCalib)", HasWildNoise);
  }
}

std::size_t ZeroUninitialised(Atlas& atlas) {
  std::size_t zeroed = 0;
  for (Map& map : atlas.maps) zeroed += ResetUninitialised(map).Total();
  return zeroed;
}

void CheckTextNumbers(const Subject& subject, Findings& findings) {
  if (!subject.atlas.encoding.text) return;
  for (const Map& map : subject.atlas.maps) {
    const auto count = std::ranges::count_if(map.keyframes, [](const KeyFrame& keyframe) {
      return !(std::isfinite(keyframe.merge_scale) && keyframe.body_position.allFinite() &&
               keyframe.imu_calibration.noise.allFinite() && keyframe.imu_calibration.walk_noise.allFinite() &&
               IsFinite(keyframe.preintegration));
    });
    if (count > 0)
      findings.Add(PlaceOf(map), "uninitialised numbers of ", count, " keyframes are written as nan or inf");
  }
}

}  // namespace slamdb::detail
