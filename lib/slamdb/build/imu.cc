// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/imu.h"

#include <algorithm>
#include <cmath>

#include "slamdb/build/detail/columns.h"
#include "slamdb/build/detail/imu.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/preintegration.h"
#include "slamdb/model/sensor.h"

namespace slamdb {
namespace {

using detail::Refuse;
using detail::RefuseRow;

bool IsFinite(const ImuBias& bias) { return bias.accelerometer.allFinite() && bias.gyroscope.allFinite(); }

bool HasFiniteMotion(const ImuPreintegration& imu) {
  return imu.covariance.allFinite() && imu.rotation.allFinite() && imu.velocity.allFinite() &&
         imu.position.allFinite() && imu.velocity_by_gyro.allFinite() && imu.position_by_gyro.allFinite();
}

void RequireCalibration(const NewImu& imu) {
  if (!detail::IsPose(imu.body_from_camera)) Refuse("imu.body_from_camera: is no pose");
  const auto is_variance = [](float number) { return number > 0 && std::isfinite(number); };
  if (!std::all_of(imu.noise.begin(), imu.noise.end(), is_variance))
    Refuse("imu.noise: variances of gyroscope and accelerometer are above 0");
  if (!std::all_of(imu.walk_noise.begin(), imu.walk_noise.end(), is_variance))
    Refuse("imu.walk_noise: variances of what biases of gyroscope and accelerometer gain are above 0");
}

void RequireMeasurements(const Column<ImuMeasurement>& measurements, std::size_t row) {
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const ImuMeasurement& measurement = measurements[i];
    if (!measurement.acceleration.allFinite() || !measurement.angular_velocity.allFinite())
      RefuseRow("imu.measurements", row, "- measurement ", i, " is not finite");
    if (!(measurement.duration > 0 && std::isfinite(measurement.duration)))
      RefuseRow("imu.measurements", row, "- measurement ", i, " lasts ", static_cast<double>(measurement.duration),
                " s; durations are above 0");
  }
}

void RequireRows(const NewImu& imu, std::size_t rows) {
  detail::RequireLength("imu.measurements", imu.measurements, rows, "timestamps");
  detail::RequireLengthOrNone("imu.velocities", imu.velocities, rows, "timestamps");
  detail::RequireLengthOrNone("imu.biases", imu.biases, rows, "timestamps");
  detail::RequireLengthOrNone("imu.integration_biases", imu.integration_biases, rows, "timestamps");
  detail::RequireLengthOrNone("imu.previous", imu.previous, rows, "timestamps");
  for (std::size_t row = 0; row < rows; ++row) {
    RequireMeasurements(imu.measurements[row], row);
    if (!imu.velocities.empty() && !imu.velocities[row].allFinite()) RefuseRow("imu.velocities", row, "is not finite");
    if (!imu.biases.empty() && !IsFinite(imu.biases[row])) RefuseRow("imu.biases", row, "is not finite");
    if (!imu.integration_biases.empty() && !IsFinite(imu.integration_biases[row]))
      RefuseRow("imu.integration_biases", row, "is not finite");
  }
}

// As after ORB-SLAM3's IMU::Preintegrated::SetNewBias.
void SetUpdatedBias(ImuPreintegration& imu, const ImuBias& bias) {
  imu.updated_bias = bias;
  imu.bias_change << bias.gyroscope - imu.bias.gyroscope, bias.accelerometer - imu.bias.accelerometer;
}

}  // namespace

void detail::RequireImu(const Map& map, const NewKeyFrames& given) {
  if (!map.keyframes.empty() && HasImu(map) != given.imu.has_value())
    Refuse("imu: the keyframes of ", map.id, " have ", given.imu ? "none" : "one",
           "; with an IMU are all keyframes of a map, or none");
  if (!given.imu) return;
  RequireCalibration(*given.imu);
  RequireRows(*given.imu, given.timestamps.size());
}

void detail::RecordImu(const NewImu& imu, std::size_t row, KeyFrame& keyframe) {
  const Rigid3f body_from_camera = imu.body_from_camera.Normalized();
  const Rigid3f camera_from_body = body_from_camera.Inverse();
  keyframe.imu_calibration = {camera_from_body, body_from_camera, imu.noise, imu.walk_noise, true};
  if (!imu.biases.empty()) keyframe.imu_bias = imu.biases[row];
  if (!imu.velocities.empty()) keyframe.velocity = imu.velocities[row];
  keyframe.has_velocity = !imu.velocities.empty();
  keyframe.body_position = (keyframe.camera_from_world.Normalized().Inverse() * camera_from_body).translation;

  ImuPreintegration& motion = keyframe.preintegration;
  motion.noise = imu.noise;
  motion.walk_noise = imu.walk_noise;
  motion.measurements = imu.measurements[row];
  Reintegrate(motion, imu.integration_biases.empty() ? keyframe.imu_bias : imu.integration_biases[row]);
  SetUpdatedBias(motion, keyframe.imu_bias);
  if (!HasFiniteMotion(motion)) RefuseRow("imu.measurements", row, "adds up to more than 32-bit floats hold");
}

void SetImuStage(Map& map, ImuStage stage) {
  if (stage != ImuStage::kNone) {
    if (!map.inertial) Refuse("stage: ", map.id, " has no keyframes with an IMU");
    for (const KeyFrame& keyframe : map.keyframes) {
      if (!keyframe.imu_calibration.is_set) Refuse("stage: ", keyframe.id, " has no calibration of the IMU");
      if (keyframe.previous && !(keyframe.preintegration.duration > 0))
        Refuse("stage: ", keyframe.id, " has no measurements of the IMU since ", keyframe.previous);
    }
  }
  map.imu_initialized = stage >= ImuStage::kInitialized;
  map.imu_ba1 = stage >= ImuStage::kAdjusted;
  map.imu_ba2 = stage >= ImuStage::kAdjustedTwice;
  for (KeyFrame& keyframe : map.keyframes) keyframe.imu_initialized = map.imu_initialized;
}

}  // namespace slamdb
