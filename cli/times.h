// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/help/tree.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/trajectory/options.h"

// How the times of a trajectory are read, for the verbs that take one.
namespace slamdb::cli {

struct TimesOptions {
  std::string unit, file;

  bool any() const { return !unit.empty() || !file.empty(); }
  TrajectoryReadOptions ForReading() const;
};

// --time-unit and --times. `whose` they are in the help of the unit: `a trajectory`.
void AddTimes(CLI::App& verb, TimesOptions& options, const std::string& whose, const std::string& group);

// Throws CLI::ValidationError when one of them would be without effect on an input of the format; null, of which
// nothing is known, has all.
void RefuseIdleTimes(const Format* input, const TimesOptions& options);

}  // namespace slamdb::cli
