// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/estimates.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/rtabmap/fixes.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/statistics.h"

namespace slamdb {
namespace {

using detail::Concat;

}  // namespace

std::string WhyIdleTimes(const Format* input, const TrajectoryReadOptions& times) {
  if (input == nullptr) return {};
  if (times.time_unit && !IsTrajectory(*input))
    return Concat("TrajectoryReadOptions::time_unit is for trajectories only; the input is ", input->title);
  if (!times.times.empty() && input->id != "kitti")
    return Concat("TrajectoryReadOptions::times is for KITTI trajectories only; the input is ", input->title);
  return {};
}

Estimates EstimatesOf(const Atlas& atlas, const std::string& path, const Format* format, bool body, Notices& notices) {
  Estimates estimates{.path = path, .format = format, .is_atlas = format == nullptr || !IsTrajectory(*format)};
  for (MapTrajectory& trajectory : TrajectoriesOf(atlas, body ? PoseFrame::kBody : PoseFrame::kCamera, &notices)) {
    const Map& map = *std::ranges::find(atlas.maps, trajectory.map, &Map::id);
    estimates.has_imu |= std::ranges::any_of(
        map.keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.imu_calibration.is_set}; });
    estimates.list.push_back(
        {.map = map.id, .poses = std::move(trajectory.poses), .open_scale = estimates.is_atlas && !IsMetric(map)});
  }
  if (body && !estimates.has_imu)
    throw Error(ErrorKind::kNotPossible, path, "", "has no IMU calibration, so that nobody knows where its body is");
  return estimates;
}

Estimates ReadEstimates(const HeldSource& held, const EstimatesOptions& options, Notices& notices) {
  ReadOptions read = options.read;
  read.features = FeatureColumns::kGeometry;  // depths tell whether the scale is open
  // Not by way of an atlas, whose single precision has no room for coordinates as UTM's.
  const std::string& path = held.source().path;
  const Format* format = FindFormatOfInput(held);
  if (const std::string idle = WhyIdleTimes(format, read.of<TrajectoryReadOptions>()); !idle.empty())
    throw Error(ErrorKind::kUsage, path, "", idle);
  if (format == nullptr || !IsTrajectory(*format))
    return EstimatesOf(ReadAtlas(held, read, &notices), path, format, options.body, notices);
  if (options.only_positions) read.format = format->id;
  Estimates estimates{.path = path, .format = format};
  for (MapTrajectory& trajectory : ReadTrajectories(held, read, &notices))
    estimates.list.push_back({.map = trajectory.map, .poses = std::move(trajectory.poses)});
  if (estimates.list.size() == 1) estimates.list.front().map = MapId();
  return estimates;
}

void KeepMaps(Estimates& estimates, const std::vector<std::uint64_t>& maps) {
  if (maps.empty()) return;
  for (const std::uint64_t map : maps)
    if (std::ranges::find(estimates.list, MapId(map), &Estimate::map) == estimates.list.end())
      throw Error(ErrorKind::kNotFound, estimates.path, "", Concat("has no map ", map, " with a trajectory"));
  std::erase_if(estimates.list, [&](const Estimate& trajectory) {
    return std::ranges::find(maps, trajectory.map.value()) == maps.end();
  });
}

Estimate TakeOnly(Estimates estimates, std::optional<std::uint64_t> map) {
  if (map) KeepMaps(estimates, {*map});
  if (estimates.list.size() != 1)
    throw Error(ErrorKind::kNotPossible, estimates.path, "",
                Concat("must hold one trajectory, not ", estimates.list.size()));
  return std::move(estimates.list.front());
}

void TellWhosePoses(const Estimates& estimate, const Estimates& truth, bool body, Notices& notices) {
  if (body && !estimate.is_atlas && !truth.is_atlas)
    throw Error(ErrorKind::kUsage, "EstimatesOptions::body is for atlases only");
  if (!body && estimate.has_imu && !truth.is_atlas)
    notices.Note(truth.format->id == "euroc"
                     ? "the truth of EuRoC is that of the IMU, and the poses here are those of the camera; "
                       "EstimatesOptions::body compares the IMU's"
                     : "the poses here are those of the camera; where the truth is that of the IMU, "
                       "EstimatesOptions::body compares the IMU's");
}

EvaluationReport EvaluateEstimates(Estimates estimate, const Estimate& truth, const EvaluationOptions& options) {
  try {
    return EvaluateTrajectories(std::move(estimate.list), truth.poses, options);
  } catch (const Error& error) {
    throw Error(error.kind(), error.path().empty() ? estimate.path : error.path(), error.place(), error.problem());
  }
}

std::string MapsText(const TrajectoryEvaluation& evaluation) {
  std::string text;
  for (const MapId map : evaluation.maps) text += (text.empty() ? "" : ", ") + std::to_string(map.value());
  if (text.empty()) return text;
  return (evaluation.maps.size() == 1 ? "map " : "maps ") + text;
}

void TellWarnings(const EvaluationReport& report, Notices& notices) {
  for (const TrajectoryEvaluation& evaluation : report.evaluations) {
    const std::string maps = MapsText(evaluation);
    for (const std::string& warning : evaluation.warnings) notices.Warn((maps.empty() ? "" : maps + ": ") + warning);
  }
}

void TellUnevaluated(const EvaluationReport& report, Notices& notices) {
  for (const UnevaluatedMap& map : report.unevaluated) notices.Warn(Concat(map.map, ": left out: ", map.reason));
}

std::vector<TimedPosition> PositionsOf(Estimates estimates) {
  std::vector<TimedPosition> positions;
  for (const TrajectoryPose& pose : TakeOnly(std::move(estimates)).poses)
    positions.push_back({pose.timestamp, pose.position});
  return positions;
}

std::vector<GpsFix> ReadRecordedFixes(const std::string& path, const FixReadOptions& options, Notices* notices) {
  const Format* format = FindFormatOfInput(Location(path, {}));
  if (format != nullptr && format->id == "rtabmap") return ReadRtabmapFixes(Location(path, {}));
  return ReadFixes(path, options, notices);
}

}  // namespace slamdb
