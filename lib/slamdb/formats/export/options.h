// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"

namespace slamdb {

// What of an atlas is written to point clouds, trajectories, tables, ndjson and MRPT's files.
struct SLAMDB_EXPORT ExportOptions {
  std::optional<MapId> map;  // only this map; nullopt: all of them
};

// How PLY and PCD are written.
struct SLAMDB_EXPORT PointCloudOptions {
  bool binary = true;  // false: ascii
};

// In which frame a trajectory is written.
enum class PoseFrame { kCamera, kBody };

struct SLAMDB_EXPORT TrajectoryOptions {
  PoseFrame pose_frame = PoseFrame::kCamera;
};

}  // namespace slamdb
