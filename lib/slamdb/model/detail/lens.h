// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "slamdb/export.h"
#include "slamdb/model/camera.h"

namespace slamdb::detail {

// A camera as optimisation needs it: in double, and with the derivative of its projection.
// A pinhole projects to undistorted pixels, as ORB-SLAM3 does; Kannala-Brandt to pixels as detected.
struct SLAMDB_EXPORT Lens {
  CameraModel model = CameraModel::kPinhole;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  std::array<double, 4> k{};              // of Kannala-Brandt

  // nullopt when the camera has not the parameters of its model, or they are not finite, or a focal length is not
  // positive.
  static std::optional<Lens> Of(const Camera& camera);

  // Pixels of a point in the camera frame, z forward. False when it is not a number, or not in front of a pinhole:
  // Kannala-Brandt sees what is beside it and behind.
  bool Project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel) const;
  // The same with its derivative by the point.
  bool Project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel, Eigen::Matrix<double, 2, 3>& by_point) const;
};

}  // namespace slamdb::detail
