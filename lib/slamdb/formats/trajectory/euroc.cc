// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/lines.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

using detail::AppendNumber;

constexpr std::string_view kPoseHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []";
constexpr std::string_view kInertialHeader =
    ", v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
    "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]";

// Rounds seconds to nanoseconds. Whole seconds and the rest are scaled apart, since their product with 1e9 has more
// bits than a double.
std::int64_t Nanoseconds(double seconds) {
  const double whole = std::floor(seconds);
  return static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((seconds - whole) * 1e9);
}

double Seconds(std::int64_t nanoseconds) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  return static_cast<double>(nanoseconds / kPerSecond) + static_cast<double>(nanoseconds % kPerSecond) / 1e9;
}

// What 64 bits of nanoseconds reach: 292 years to both sides.
bool FitsNanoseconds(double seconds) { return std::abs(seconds) < 9.2e9; }

void AppendLine(std::string& out, const detail::TimedPose& pose, bool inertial) {
  AppendNumber(out, Nanoseconds(pose.timestamp));
  const auto add = [&out](float value) {
    out += ',';
    AppendNumber(out, value);
  };
  const Quaternionf& rotation = pose.world_from_it.rotation;
  for (const float value : pose.world_from_it.translation) add(value);
  for (const float value : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) add(value);
  if (inertial) {
    for (const float value : pose.keyframe->velocity) add(value);
    for (const float value : pose.keyframe->imu_bias.gyroscope) add(value);
    for (const float value : pose.keyframe->imu_bias.accelerometer) add(value);
  }
  out += '\n';
}

void DropUnreachableTimes(std::vector<detail::MapTrajectory>& trajectories, Notices& notices) {
  std::size_t dropped = 0;
  for (detail::MapTrajectory& trajectory : trajectories)
    dropped +=
        std::erase_if(trajectory.poses, [](const detail::TimedPose& pose) { return !FitsNanoseconds(pose.timestamp); });
  std::erase_if(trajectories, [](const detail::MapTrajectory& trajectory) { return trajectory.poses.empty(); });
  if (dropped > 0)
    notices.Warn(
        "left out because their time does not fit into 64 bits of nanoseconds (was it recorded in seconds?): " +
        detail::Counted(dropped, "keyframe"));
}

bool IsInertial(const std::vector<detail::MapTrajectory>& trajectories) {
  return std::any_of(trajectories.begin(), trajectories.end(), [](const detail::MapTrajectory& trajectory) {
    return std::any_of(trajectory.poses.begin(), trajectory.poses.end(),
                       [](const detail::TimedPose& pose) { return bool{pose.keyframe->imu_calibration.is_set}; });
  });
}

void WriteEuroc(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, detail::FileOptions(options));
  detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  DropUnreachableTimes(trajectories.maps, notices);
  std::vector<const Map*> maps;
  for (const detail::MapTrajectory& trajectory : trajectories.maps) maps.push_back(trajectory.map);
  detail::WarnOfSeveralFrames(maps, "lines `# map N` tell them apart", notices);
  const bool inertial = IsInertial(trajectories.maps);
  file.Write(kPoseHeader);
  if (inertial) file.Write(kInertialHeader);
  file.Write("\n");
  for (const auto& [map, poses] : trajectories.maps) {
    if (trajectories.maps.size() > 1) file.Write(detail::MapComment(map->id));
    std::string lines;
    for (const detail::TimedPose& pose : poses) AppendLine(lines, pose, inertial);
    file.Write(lines);
  }
  file.Commit();
  notices.Tell(trajectories.Summary());
}

const detail::TableKind& Kind() {
  static const detail::TableKind kind = {
      .columns = {{{"timestamp"}},
                  {{"p_rs_r_x"}},
                  {{"p_rs_r_y"}},
                  {{"p_rs_r_z"}},
                  {{"q_rs_w"}},
                  {{"q_rs_x"}},
                  {{"q_rs_y"}},
                  {{"q_rs_z"}}},
      .expected = "at least 8 cells: timestamp [ns], position x y z, quaternion w x y z",
      .more_cells = true};
  return kind;
}

detail::ReadPose PoseOf(const detail::Table& table) {
  const auto nanoseconds = table.Get<std::int64_t>(0, "whole nanoseconds");
  const auto v = detail::NumbersBehindTime(table);
  const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
  return {Seconds(nanoseconds), {Quaternionf(rotation.cast<float>()), Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()}};
}

Atlas ReadEuroc(const Source& source, const ReadOptions& options, Notices&) {
  return detail::ReadPoses(source, options, Kind(), PoseOf);
}

// The names of the columns, which are not those of the IMU and image csv of the same data set.
bool SniffEuroc(const Probe& probe) { return detail::GlanceAtTable(probe.head, Kind()).named; }

constexpr std::array<std::string_view, 1> kSuffixes = {".euroc.csv"};

}  // namespace

const Format detail::kEurocFormat = {.id = "euroc",
                                     .title = "EuRoC ground truth csv",
                                     .suffixes = kSuffixes,
                                     .chooses_maps = true,
                                     .is_export = true,
                                     .reads = Content::kPoses | Content::kMaps,
                                     .writes = Content::kPoses | Content::kMaps,
                                     .sniff = SniffEuroc,
                                     .read = ReadEuroc,
                                     .write = WriteEuroc};

}  // namespace slamdb
