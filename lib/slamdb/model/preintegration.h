// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "slamdb/export.h"
#include "slamdb/model/imu.h"

namespace slamdb {

// Seconds by which a preintegration and the times of its keyframes may differ.
inline constexpr double kPreintegrationTolerance = 0.02;

// Integrates `imu.measurements` anew with `bias` and `imu.noise`, `imu.walk_noise`.
// Every other field is set as after ORB-SLAM3's IMU::Preintegrated::Initialize and one IntegrateNewMeasurement each.
// Sums are double, so results agree with ORB-SLAM3's float sums to float accuracy.
//
// Cost: linear in the measurements.
// After Forster et al., TRO 2017, equations 35 to 38 and 63, and the bias Jacobians of their appendix.
SLAMDB_EXPORT void Reintegrate(ImuPreintegration& imu, const ImuBias& bias);

// Prolongs `imu` backwards over the gap that removing keyframes leaves.
// `earlier` are the preintegrations before it, in order of time, each ending where the next begins.
// The measurements are joined and integrated anew with the latest bias of `imu`.
// False, and nothing changes, when one of them holds no measurements.
//
// Cost: linear in the measurements.
// After what ORB-SLAM3 does when it culls a keyframe (MergePrevious).
SLAMDB_EXPORT bool JoinPreintegrations(std::span<const ImuPreintegration* const> earlier, ImuPreintegration& imu);

}  // namespace slamdb
