// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/export.h"
#include "slamdb/model/up.h"

namespace slamdb {

// How keyframes are laid onto positions.
struct FitOptions {
  std::optional<double> max_time_difference;  // seconds; by default 0.02 for trajectories and 1 for GPS
  bool body = false;                          // the positions are those of the IMU, not of the camera
  std::optional<bool> with_scale;             // by default only where the map has none of its own, see IsMetric
  // Pairs that end up farther apart are left out; units of the reference. By default gross outliers are
  // (UmeyamaOptions::leave_out_gross), and named in a warning; infinity keeps every pair.
  std::optional<double> outlier_distance;
  double time_offset = 0;             // seconds that the reference's clock is ahead of the maps'
  bool estimate_time_offset = false;  // find it for each map instead
};

// Where maps go. Each map of an atlas has a frame of its own, so all but the first find a transform for each.
struct TurnUpright {
  std::optional<UpMethod> method;  // by default what tells it best, see FindUp
};
struct OntoTrajectory {
  std::vector<TimedPosition> reference;
  FitOptions fit;
};
struct OntoEarth {
  std::vector<GpsFix> fixes;       // at least one with a place
  std::optional<Geodetic> origin;  // of east, north, up; by default the first fix that is near the others
  FitOptions fit;
};
using Destination = std::variant<Similarity3d, TurnUpright, OntoTrajectory, OntoEarth>;

struct TransformOptions {
  Destination to;           // by default the maps stay where they are
  std::vector<MapId> maps;  // only these; by default all, but for those without keyframes when a transform is sought
  int threads = 0;          // 0: every core
  Progress progress;        // may be empty
};

// How one map moved, and why so.
struct MovedMap {
  MapId map;
  Similarity3d target_from_source;
  std::optional<TrajectoryAlignment> alignment;
  std::optional<Up> up;               // before the move, where it was turned upright
  std::vector<std::string> warnings;  // TransformWarnings, outliers, and a poor fit
  std::vector<std::string> losses;    // what the single precision of maps cannot hold of the result
};

struct TransformReport {
  std::vector<MovedMap> maps;
  std::optional<Geodetic> origin;  // of east, north, up, when the maps were laid onto the earth
};

// Finds where each map goes, and moves it there (TransformMap). Every transform is found before anything moves.
//
// Throws Error, and then changes nothing:
//   kUsage        the transform is none (RequireTransform), there are no fixes, or the origin is no place
//   kNotPossible  a map is not there, none is left to move, or one does not tell its transform (AlignToTrajectory,
//                 FindUp)
// Cost: linear, in place; the bytes are the same for any number of threads.
SLAMDB_EXPORT TransformReport TransformAtlas(Atlas& atlas, const TransformOptions& options = {});

// What is doubtful, and what is lost, each behind its map.
SLAMDB_EXPORT void TellWarnings(const TransformReport& report, Notices& notices);

// As schema/transform.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const TransformReport& report, const ReportFiles& files = {});

}  // namespace slamdb
