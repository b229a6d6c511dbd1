// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/options.h"
#include "cli/times.h"
#include "slamdb/base/notices.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/many/estimates.h"

// What verbs hold against each other: trajectories of files, and of the maps of atlases.
namespace slamdb::cli {

class Console;

struct TrajectoriesOptions {
  TimesOptions times;
  std::string layout = {};      // of an .osa file of a fork, as --layout has it
  bool body = false;            // of atlases: where the IMU is, not the camera
  bool only_positions = false;  // in which order a file has quaternions does not matter then
  double wait = kUsualWait;
};

// Ends with exit code 2 where options for times would be without effect.
Estimates ReadTrajectoriesOf(const std::string& path, const TrajectoriesOptions& options, Console& console,
                             Notices& notices);

// Ends with exit code 2 where --body has no effect.
void RefuseIdleBody(const Estimates& estimate, const Estimates& truth, bool body);

// How the poses are paired, and laid onto the truth.
void AddPairing(CLI::App& verb, EvaluationOptions& options, TimesOptions& times, const std::string& group);
void AddAlignment(CLI::App& verb, EvaluationOptions& options, const std::string& group);

}  // namespace slamdb::cli
