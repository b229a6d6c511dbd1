// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

// What tells an atlas from others in a table.
struct AtlasSummary {
  std::uint64_t maps = 0, keyframes = 0, points = 0, landmarks = 0;  // all that are stored, the bad ones too
  std::uint64_t observations = 0;                                    // of points by keyframes
  std::vector<MapSensor> sensors;              // of maps with keyframes, each once, in the order of MapSensor
  bool has_imu = false;                        // some map has
  bool is_metric = true;                       // false: the length is in units of a map whose scale is not known
  double trajectory_length = 0;                // as MapStatistics has it, summed over the maps
  double duration = 0;                         // seconds from first to last keyframe, summed over the maps
  std::optional<double> begin_time, end_time;  // of all maps; seconds; none: no keyframe has a time
};

// Counts and measures that; a small part of what ComputeStatistics does.
//
// Throws nothing but std::bad_alloc.
// Cost: linear. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT AtlasSummary Summarize(const Atlas& atlas);

}  // namespace slamdb
