// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"

namespace slamdb {

// What of an atlas is written to point clouds, trajectories, scenes, tables, ndjson and MRPT's files.
struct SLAMDB_EXPORT ExportOptions {
  std::optional<MapId> map;  // only this map; nullopt: all of them
};

// What the colour of a point tells.
enum class PointColor {
  kMap,           // the map that it is in
  kError,         // its mean reprojection error
  kObservations,  // how many keyframes see it
  kHeight,        // along the axis of the map that is nearest to up
  kAge,           // the keyframe that made it
};

// How points are written.
struct SLAMDB_EXPORT PointCloudOptions {
  bool binary = true;                   // PLY, PCD; false: ascii
  PointColor color = PointColor::kMap;  // PLY, PCD, glTF, MCAP
  bool cameras = false;                 // PLY; true: the cameras and their path too, as edges
};

// In which frame a trajectory is written.
enum class PoseFrame { kCamera, kBody };

struct SLAMDB_EXPORT TrajectoryOptions {
  PoseFrame pose_frame = PoseFrame::kCamera;
};

}  // namespace slamdb
