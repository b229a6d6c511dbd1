// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"

// Trajectories in double precision and with all their digits, past the atlas, which is single precision.
namespace slamdb {

// world_from_camera at a time in seconds.
struct TrajectoryPose {
  double timestamp = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

// Whether files of the format are trajectories and nothing else: tum, euroc, kitti.
[[nodiscard]] SLAMDB_EXPORT bool IsTrajectory(const Format& format);

// The poses of a trajectory, in the order of the file. The second takes an input that was looked at before.
//
// Throws Error as ReadAtlas, and kNotPossible when the file holds several trajectories.
[[nodiscard]] SLAMDB_EXPORT std::vector<TrajectoryPose> ReadTrajectory(const Location& location,
                                                                       const ReadOptions& options = {},
                                                                       Notices* notices = nullptr);
[[nodiscard]] SLAMDB_EXPORT std::vector<TrajectoryPose> ReadTrajectory(const HeldSource& held,
                                                                       const ReadOptions& options = {},
                                                                       Notices* notices = nullptr);

// Writes a trajectory as another one, with every digit that it has; of a selection what ReadOptions say.
// Returns how many poses were written.
//
// Throws Error as ReadAtlas and WriteAtlas do, and kNotFound, before anything is written, when nothing of what is there
// is selected.
SLAMDB_EXPORT std::size_t ConvertTrajectory(const Location& input, const Location& output, const ReadOptions& read = {},
                                            const WriteOptions& write = {}, Notices* notices = nullptr);
SLAMDB_EXPORT std::size_t ConvertTrajectory(const HeldSource& held, const Location& output,
                                            const ReadOptions& read = {}, const WriteOptions& write = {},
                                            Notices* notices = nullptr);

}  // namespace slamdb
