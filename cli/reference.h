// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/times.h"
#include "slamdb/base/notices.h"
#include "slamdb/edit/frame/align_trajectory.h"

namespace slamdb::cli {

class Console;

// What a map is held against: the positions of a trajectory, or of the one map of another atlas, there of the body
// (IMU) where that is asked for. Throws Error when the file holds no one trajectory, and ends with exit code 2 where
// options for times would be without effect.
std::vector<TimedPosition> ReadReference(const std::string& path, const TimesOptions& times, bool body, double wait,
                                         Console& console, Notices& notices);

}  // namespace slamdb::cli
