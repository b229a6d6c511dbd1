// SPDX-License-Identifier: BSD-3-Clause
#include "cli/reference.h"

#include "cli/choices.h"
#include "cli/values.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {

Estimates ReadTrajectoriesOf(const std::string& path, const TrajectoriesOptions& options, Console& console,
                             Notices& notices) {
  EstimatesOptions estimates{.read = MakeReadOptions(console, {.format = {}, .layout = options.layout}, options.wait),
                             .body = options.body,
                             .only_positions = options.only_positions};
  estimates.read.of<TrajectoryReadOptions>() = options.times.ForReading();
  const HeldSource held = HoldInput(path, estimates.read);
  RefuseIdleTimes(FindFormatOfInput(held), options.times);
  return ReadEstimates(held, estimates, notices);
}

void RefuseIdleBody(const Estimates& estimate, const Estimates& truth, bool body) {
  if (body && !estimate.is_atlas && !truth.is_atlas) RefuseUsage("--body is for atlases only");
}

void AddPairing(CLI::App& verb, EvaluationOptions& options, TimesOptions& times, const std::string& group) {
  verb.add_option("--max-dt", options.max_time_difference, "Seconds that the poses of a pair may be apart")
      ->type_name("SECONDS")
      ->check(Within(kNonNegative))
      ->capture_default_str()
      ->group(group);
  CLI::Option* offset = verb.add_option("--time-offset", options.time_offset,
                                        "Seconds that the clock of the truth is ahead of the estimate's")
                            ->type_name("SECONDS")
                            ->check(Within(kFinite))
                            ->group(group);
  CLI::Option* estimate_offset = verb.add_flag("--estimate-time-offset", options.estimate_time_offset,
                                               "Find the time offset under which speeds and paths agree best")
                                     ->excludes(offset)
                                     ->group(group);
  verb.add_flag("--by-index", options.by_index, "Pair the first pose with the first, whatever the times")
      ->excludes(offset)
      ->excludes(estimate_offset)
      ->group(group);
  AddTimes(verb, times, "the truth", group);
}

void AddAlignment(CLI::App& verb, EvaluationOptions& options, const std::string& group) {
  verb.add_option(
          "--align", options.alignment,
          "How the estimate is laid onto the truth: none, origin (first pose onto first), scale, se3 or sim3; by "
          "default sim3 for a map whose sensor leaves the scale open, and se3 else")
      ->type_name("HOW")
      ->transform(OneOf(kAlignments))
      ->group(group);
}

}  // namespace slamdb::cli
