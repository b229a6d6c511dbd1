// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/trajectory/options.h"

// What is held against each other: trajectories of files, and of the maps of atlases.
namespace slamdb {

struct Estimates {
  std::string path;  // for messages
  std::vector<Estimate> list;
  const Format* format = nullptr;  // of the file; null: it is not known
  bool is_atlas = false, has_imu = false;
};

struct EstimatesOptions {
  ReadOptions read;             // layout and times of trajectories among them
  bool body = false;            // of atlases: where the IMU is, not the camera
  bool only_positions = false;  // in which order a file has quaternions does not matter then
};

// Why options for times would be without effect on an input of the format; empty: they are not. Null, of which nothing
// is known, has all.
[[nodiscard]] SLAMDB_EXPORT std::string WhyIdleTimes(const Format* input, const TrajectoryReadOptions& times);

// Of an atlas, or a file of trajectories, whose coordinates keep their double precision.
//
// Throws Error as ReadAtlas and EstimatesOf do; kUsage: options for times would be without effect.
[[nodiscard]] SLAMDB_EXPORT Estimates ReadEstimates(const HeldSource& held, const EstimatesOptions& options,
                                                    Notices& notices);

// Of an atlas that was read from a file of that format, which may be one of trajectories; null: it is not known.
//
// Throws Error (kNotPossible) when the body is asked for, and nothing tells where it is.
[[nodiscard]] SLAMDB_EXPORT Estimates EstimatesOf(const Atlas& atlas, const std::string& path, const Format* format,
                                                  bool body, Notices& notices);

// The one that there is, or that of the map. Throws Error when there is not one.
[[nodiscard]] SLAMDB_EXPORT Estimate TakeOnly(Estimates estimates, std::optional<std::uint64_t> map = {});

// Leaves only those of the maps; all when there are none. Throws Error (kNotFound) for a map that is not there.
SLAMDB_EXPORT void KeepMaps(Estimates& estimates, const std::vector<std::uint64_t>& maps);

// Says what is compared where that is likely to be a mistake. Throws Error (kUsage) when `body` has no effect.
SLAMDB_EXPORT void TellWhosePoses(const Estimates& estimate, const Estimates& truth, bool body, Notices& notices);

// Evaluates all estimates against the only truth, or that of the map; see EvaluateTrajectories.
[[nodiscard]] SLAMDB_EXPORT EvaluationReport EvaluateEstimates(Estimates estimate, const Estimate& truth,
                                                               const EvaluationOptions& options);

// `map 0`, `maps 0, 3`; empty for what is of no map.
[[nodiscard]] SLAMDB_EXPORT std::string MapsText(const TrajectoryEvaluation& evaluation);

// Every warning of the report, with the map that it is about.
SLAMDB_EXPORT void TellWarnings(const EvaluationReport& report, Notices& notices);

// What could not be evaluated, and why.
SLAMDB_EXPORT void TellUnevaluated(const EvaluationReport& report, Notices& notices);

// The positions of the only trajectory.
[[nodiscard]] SLAMDB_EXPORT std::vector<TimedPosition> PositionsOf(Estimates estimates);

// GPS fixes of a table or of NMEA sentences, or those that a database of RTAB-Map has recorded.
//
// Throws Error as ReadFixes and ReadRtabmapFixes do.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ReadRecordedFixes(const std::string& path,
                                                                  const FixReadOptions& options = {},
                                                                  Notices* notices = nullptr);

}  // namespace slamdb
