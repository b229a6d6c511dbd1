// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "slamdb/model/ids.h"

// Trajectories in double precision and with all their digits, past the atlas, which is single precision.
namespace slamdb {

// world_from_camera, or world_from_body, at a time in seconds.
struct TrajectoryPose {
  double timestamp = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

// The poses of one map, in a frame of its own.
struct MapTrajectory {
  MapId map;
  std::vector<TrajectoryPose> poses;
};

}  // namespace slamdb
