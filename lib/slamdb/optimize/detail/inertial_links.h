// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// What the IMU measured between two keyframes in a row, in double.
struct InertialLink {
  std::uint32_t first, second;  // rows of keyframes
  double duration;              // seconds
  Eigen::Matrix3d rotation;     // first_from_second body
  Eigen::Vector3d velocity, position;
  Eigen::Matrix<double, 6, 1> bias;  // gyroscope, accelerometer, that it was integrated with
  Eigen::Matrix3d rotation_by_gyro;
  Eigen::Matrix<double, 3, 6> velocity_by_bias, position_by_bias;
  Eigen::Matrix<double, 9, 9> root_information;  // of rotation, velocity, position: its product with errors is white
  Eigen::Matrix<double, 6, 1> walk_root_information;
  Eigen::Matrix3d camera_from_body, second_camera_from_body;  // rotations
  Eigen::Vector3d body, second_body;                          // where it is in the camera's frame
};

// Of a map whose IMU is initialised and whose gravity is along -z: the links between good keyframes that were recorded
// with measurements and a covariance that is one. Others are left out; of an upright map they are counted in
// `unusable`.
std::vector<InertialLink> FindInertialLinks(const Map& map, std::uint64_t& unusable);

// How far the gravity that the inertial data tell may be off -z, degrees.
inline constexpr double kLargestTilt = 5;

// Whether a map knows gravity: its IMU is initialised, and gravity is along -z.
bool KnowsGravity(const Map& map);

// Along -z; ORB-SLAM3's value.
inline constexpr double kGravity = 9.81;  // m/s^2

}  // namespace slamdb::detail
