// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Keyframes of sessions with an IMU.
namespace slamdb {

// What an IMU says of new keyframes, row by row as they are. What is behind the measurements may be empty.
//
// The measurements of a keyframe begin at the one before it in time and end at it. Where there are none, nothing leads
// to the keyframe: it begins a chain. One that comes between two of a chain takes its part of what led to the later.
struct NewImu {
  Rigid3f body_from_camera;                // of the left camera; a unit quaternion
  Vector6f noise = Vector6f::Zero();       // variances of one measurement, gyroscope and accelerometer: (rad/s)^2,
  Vector6f walk_noise = Vector6f::Zero();  // (m/s^2)^2; and what biases gain with each. Above 0
  std::vector<Column<ImuMeasurement>> measurements;
  std::vector<Eigen::Vector3f> velocities;  // m/s, world; empty: unknown
  std::vector<ImuBias> biases;              // empty: 0
  std::vector<ImuBias> integration_biases;  // those that were integrated with; empty: `biases`
  std::vector<KeyFrameId> previous;         // none where a chain begins; empty: the ones before in time
};

// How far the IMU of a map is. Each stage stands for those before it, too.
enum class ImuStage {
  kNone,         // nothing is known of gravity
  kInitialized,  // the world is metric, with z up
  kAdjusted,     // ORB-SLAM3's first inertial bundle adjustment is done
  kAdjustedTwice,
};

// Says so of a map and its keyframes; those that are added later are alike.
//
// Throws Error (kUsage) with the keyframe that has no calibration, or a previous one and no preintegration since; then
// nothing is changed.
SLAMDB_EXPORT void SetImuStage(Map& map, ImuStage stage);

}  // namespace slamdb
