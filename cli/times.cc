// SPDX-License-Identifier: BSD-3-Clause
#include "cli/times.h"

#include "cli/options.h"
#include "cli/words.h"
#include "slamdb/many/estimates.h"

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
  const std::string why = WhyIdleTimes(input, options.ForReading());
  if (!why.empty()) RefuseUsage(InCommandWords(why));
}

}  // namespace slamdb::cli
