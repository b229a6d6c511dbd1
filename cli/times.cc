// SPDX-License-Identifier: BSD-3-Clause
#include "cli/times.h"

#include "cli/options.h"
#include "slamdb/formats/trajectories.h"

namespace slamdb::cli {

TrajectoryReadOptions TimesOptions::ForReading() const { return {TimeUnitByName(unit), file}; }

void AddTimes(CLI::App& verb, TimesOptions& options, const std::string& whose, const std::string& group) {
  verb.add_option("--time-unit", options.unit,
                  "What the times of " + whose + " count; by default as its columns say, or as the times tell")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}))
      ->group(group);
  verb.add_option("--times", options.file, "The times of a KITTI trajectory; by default a file beside it")
      ->type_name("FILE")
      ->group(group);
}

void RefuseIdleTimes(const Format* input, const TimesOptions& options) {
  if (input == nullptr) return;
  const std::string is = " only; the input is " + std::string(input->title);
  if (!options.unit.empty() && !IsTrajectory(*input)) RefuseUsage("--time-unit is for trajectories" + is);
  if (!options.file.empty() && input->id != "kitti") RefuseUsage("--times is for KITTI trajectories" + is);
}

}  // namespace slamdb::cli
