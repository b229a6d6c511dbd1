// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/base/column.h"
#include "slamdb/model/flag.h"
#include "slamdb/model/rigid.h"

namespace slamdb {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix15f = Eigen::Matrix<float, 15, 15>;  // rows: rotation 0-2, velocity 3-5, position 6-8, gyro bias, acc bias

// ORB-SLAM3: IMU::Bias.
struct ImuBias {
  Eigen::Vector3f accelerometer = Eigen::Vector3f::Zero();  // m/s^2   bax bay baz
  Eigen::Vector3f gyroscope = Eigen::Vector3f::Zero();      // rad/s   bwx bwy bwz
};

// One IMU sample between two keyframes. ORB-SLAM3: IMU::Preintegrated::integrable.
struct ImuMeasurement {
  Eigen::Vector3f acceleration;      // m/s^2, body frame      a
  Eigen::Vector3f angular_velocity;  // rad/s, body frame      w
  float duration;                    // seconds                t
};
static_assert(sizeof(ImuMeasurement) == 28);

// IMU motion between the previous keyframe and this one (Forster et al., TRO 2017).
// ORB-SLAM3: IMU::Preintegrated.
// Uninitialised memory in files of keyframes without IMU data (all but `bias` and `updated_bias`): kept as recorded.
struct ImuPreintegration {
  float duration = 0;                                               // seconds                dT
  Matrix15f covariance = Matrix15f::Zero();                         //                        C
  Matrix15f information = Matrix15f::Zero();                        //                        Info
  Vector6f noise = Vector6f::Zero();                                // gyro, acc variances    Nga (diagonal)
  Vector6f walk_noise = Vector6f::Zero();                           // gyro, acc variances    NgaWalk (diagonal)
  ImuBias bias;                                                     // integrated with        b
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Zero();               // body_i_from_body_j     dR
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();               // m/s, body_i            dV
  Eigen::Vector3f position = Eigen::Vector3f::Zero();               // m, body_i              dP
  Eigen::Matrix3f rotation_by_gyro = Eigen::Matrix3f::Zero();       // Jacobians by the bias  JRg
  Eigen::Matrix3f velocity_by_gyro = Eigen::Matrix3f::Zero();       //                        JVg
  Eigen::Matrix3f velocity_by_acc = Eigen::Matrix3f::Zero();        //                        JVa
  Eigen::Matrix3f position_by_gyro = Eigen::Matrix3f::Zero();       //                        JPg
  Eigen::Matrix3f position_by_acc = Eigen::Matrix3f::Zero();        //                        JPa
  Eigen::Vector3f mean_acceleration = Eigen::Vector3f::Zero();      // m/s^2                  avgA
  Eigen::Vector3f mean_angular_velocity = Eigen::Vector3f::Zero();  // rad/s                avgW
  ImuBias updated_bias;                                             //                        bu
  Vector6f bias_change = Vector6f::Zero();                          // gyro, acc: bu - b      db
  Column<ImuMeasurement> measurements;                              // in time order          mvMeasurements
};

// ORB-SLAM3: IMU::Calib.
// The noise fields are uninitialised in files where is_set is false.
struct ImuCalibration {
  Rigid3f camera_from_body;                // mTcb
  Rigid3f body_from_camera;                // mTbc
  Vector6f noise = Vector6f::Zero();       // gyro, acc variances   Cov (diagonal)
  Vector6f walk_noise = Vector6f::Zero();  // gyro, acc variances   CovWalk (diagonal)
  Flag is_set;                             // mbIsSet
};

}  // namespace slamdb
