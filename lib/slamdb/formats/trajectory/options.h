// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/base/time_unit.h"
#include "slamdb/export.h"

namespace slamdb {

// How trajectories are read.
struct SLAMDB_EXPORT TrajectoryReadOptions {
  std::optional<TimeUnit> time_unit;  // by default as the table says, or its times tell
  std::string times;  // the file of the times of a KITTI trajectory; by default one that is found beside it
};

}  // namespace slamdb
