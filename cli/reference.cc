// SPDX-License-Identifier: BSD-3-Clause
#include "cli/reference.h"

#include <algorithm>

#include "cli/values.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/statistics.h"

namespace slamdb::cli {

Trajectories TrajectoriesOfAtlas(const Atlas& atlas, const std::string& path, const Format* format, bool body,
                                 Notices& notices) {
  Trajectories trajectories{.path = path, .format = format, .is_atlas = format == nullptr || !IsTrajectory(*format)};
  for (MapTrajectory& trajectory : TrajectoriesOf(atlas, body ? PoseFrame::kBody : PoseFrame::kCamera, &notices)) {
    const Map& map = *std::ranges::find(atlas.maps, trajectory.map, &Map::id);
    trajectories.has_imu |= std::ranges::any_of(
        map.keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.imu_calibration.is_set}; });
    trajectories.list.push_back(
        {.map = map.id, .poses = std::move(trajectory.poses), .open_scale = trajectories.is_atlas && !IsMetric(map)});
  }
  if (body && !trajectories.has_imu)
    throw Error(ErrorKind::kNotPossible, path, "", "has no IMU calibration, so that nobody knows where its body is");
  return trajectories;
}

Trajectories ReadTrajectoriesOf(const std::string& path, const TrajectoriesOptions& options, Console& console,
                                Notices& notices) {
  ReadOptions read = MakeReadOptions(console, {.format = {}, .layout = options.layout}, options.wait);
  read.features = FeatureColumns::kGeometry;  // depths tell whether the scale is open
  read.of<TrajectoryReadOptions>() = options.times.ForReading();
  // Not by way of an atlas, whose single precision has no room for coordinates as UTM's.
  const HeldSource held = HoldInput(path, read);
  const Format* format = FindFormatOfInput(held);
  RefuseIdleTimes(format, options.times);
  if (format == nullptr || !IsTrajectory(*format))
    return TrajectoriesOfAtlas(ReadAtlas(held, read, &notices), held.source().path, format, options.body, notices);
  if (options.only_positions) read.format = format->id;
  Trajectories trajectories{.path = path, .format = format};
  for (MapTrajectory& trajectory : ReadTrajectories(held, read, &notices))
    trajectories.list.push_back({.map = trajectory.map, .poses = std::move(trajectory.poses)});
  if (trajectories.list.size() == 1) trajectories.list.front().map = MapId();
  return trajectories;
}

void KeepMaps(Trajectories& trajectories, const std::vector<std::uint64_t>& maps) {
  if (maps.empty()) return;
  for (const std::uint64_t map : maps)
    if (std::ranges::find(trajectories.list, MapId(map), &Estimate::map) == trajectories.list.end())
      throw Error(ErrorKind::kNotFound, trajectories.path, "",
                  detail::Concat("has no map ", map, " with a trajectory"));
  std::erase_if(trajectories.list, [&](const Estimate& trajectory) {
    return std::ranges::find(maps, trajectory.map.value()) == maps.end();
  });
}

Estimate TakeOnly(Trajectories trajectories, std::optional<std::uint64_t> map) {
  if (map) KeepMaps(trajectories, {*map});
  if (trajectories.list.size() != 1)
    throw Error(ErrorKind::kNotPossible, trajectories.path, "",
                detail::Concat("must hold one trajectory, not ", trajectories.list.size()));
  return std::move(trajectories.list.front());
}

void TellWhosePoses(const Trajectories& estimate, const Trajectories& truth, bool body, Notices& notices) {
  if (body && !estimate.is_atlas && !truth.is_atlas) RefuseUsage("--body is for atlases only");
  if (!body && estimate.has_imu && !truth.is_atlas)
    notices.Note(truth.format->id == "euroc" ? "the truth of EuRoC is that of the IMU, and the poses here are those of "
                                               "the camera; --body compares the IMU's"
                                             : "the poses here are those of the camera; where the truth is that of the "
                                               "IMU, --body compares the IMU's");
}

std::vector<TimedPosition> ReadReference(const std::string& path, const TimesOptions& times, bool body, double wait,
                                         Console& console, Notices& notices) {
  std::vector<TimedPosition> positions;
  for (const TrajectoryPose& pose :
       TakeOnly(ReadTrajectoriesOf(path, {.times = times, .body = body, .only_positions = true, .wait = wait}, console,
                                   notices))
           .poses)
    positions.push_back({pose.timestamp, pose.position});
  return positions;
}

void AddPairing(CLI::App& verb, EvaluationOptions& options, TimesOptions& times, const std::string& group) {
  verb.add_option("--max-dt", options.max_time_difference, "Seconds that the poses of a pair may be apart")
      ->type_name("SECONDS")
      ->check(CheckNonNegative)
      ->capture_default_str()
      ->group(group);
  CLI::Option* offset = verb.add_option("--time-offset", options.time_offset,
                                        "Seconds that the clock of the truth is ahead of the estimate's")
                            ->type_name("SECONDS")
                            ->check(CheckFinite)
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
      ->transform(OneOf<AlignmentKind>({{"none", AlignmentKind::kNone},
                                        {"origin", AlignmentKind::kOrigin},
                                        {"scale", AlignmentKind::kScale},
                                        {"se3", AlignmentKind::kSe3},
                                        {"sim3", AlignmentKind::kSim3}}))
      ->group(group);
}

}  // namespace slamdb::cli
