// SPDX-License-Identifier: BSD-3-Clause
#include "cli/idle_times.h"

#include "cli/options.h"
#include "slamdb/formats/trajectories.h"

namespace slamdb::cli {

void RefuseIdleTimes(const Format& input, const std::string& time_unit, const std::string& times) {
  const std::string is = " only; the input is " + std::string(input.title);
  if (!time_unit.empty() && !IsTrajectory(input)) RefuseUsage("--time-unit is for trajectories" + is);
  if (!times.empty() && input.id != "kitti") RefuseUsage("--times is for KITTI trajectories" + is);
}

}  // namespace slamdb::cli
