// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/options.h"
#include "cli/times.h"
#include "slamdb/base/notices.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/evaluate/evaluate.h"

// What verbs hold against each other: trajectories of files, and of the maps of atlases.
namespace slamdb::cli {

class Console;

struct Trajectories {
  std::string path;
  std::vector<Estimate> list;
  const Format* format = nullptr;
  bool is_atlas = false, has_imu = false;
};

struct TrajectoriesOptions {
  TimesOptions times;
  std::string layout = {};      // of an .osa file of a fork, as --layout has it
  bool body = false;            // of atlases: where the IMU is, not the camera
  bool only_positions = false;  // in which order a file has quaternions does not matter then
  double wait = kUsualWait;
};

// Ends with exit code 2 where options for times would be without effect.
Trajectories ReadTrajectoriesOf(const std::string& path, const TrajectoriesOptions& options, Console& console,
                                Notices& notices);
// Of an atlas that was read from a file of that format, which may be one of trajectories; null: it is not known.
Trajectories TrajectoriesOfAtlas(const Atlas& atlas, const std::string& path, const Format* format, bool body,
                                 Notices& notices);

// The one that there is, or that of the map. Throws Error when there is not one.
Estimate TakeOnly(Trajectories trajectories, std::optional<std::uint64_t> map = {});
// Leaves only those of the maps; all when there are none. Throws Error for a map that is not there.
void KeepMaps(Trajectories& trajectories, const std::vector<std::uint64_t>& maps);

// Says what is compared where that is likely to be a mistake; ends with exit code 2 where --body has no effect.
void TellWhosePoses(const Trajectories& estimate, const Trajectories& truth, bool body, Notices& notices);

// The positions of the only trajectory.
std::vector<TimedPosition> ReadReference(const std::string& path, const TimesOptions& times, bool body, double wait,
                                         Console& console, Notices& notices);

// How the poses are paired, and laid onto the truth.
void AddPairing(CLI::App& verb, EvaluationOptions& options, TimesOptions& times, const std::string& group);
void AddAlignment(CLI::App& verb, EvaluationOptions& options, const std::string& group);

}  // namespace slamdb::cli
