// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/times.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

using detail::AppendNumber;
using detail::FitsNanoseconds;
using detail::Nanoseconds;

constexpr std::string_view kPoseHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []";
constexpr std::string_view kInertialHeader =
    ", v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
    "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]";

void AppendPose(std::string& out, const detail::PoseText& pose) {
  for (const std::string& number : pose.position) out.append(",").append(number);
  const auto& [x, y, z, w] = pose.rotation;
  for (const std::string* number : {&w, &x, &y, &z}) out.append(",").append(*number);
}

void AppendLine(std::string& out, const detail::TimedPose& pose, bool inertial) {
  AppendNumber(out, Nanoseconds(pose.timestamp));
  detail::PoseText text;
  detail::SetText(text, pose.world_from_it.translation, pose.world_from_it.rotation);
  AppendPose(out, text);
  const auto add = [&out](float value) {
    out += ',';
    AppendNumber(out, value);
  };
  if (inertial) {
    for (const float value : pose.keyframe->velocity) add(value);
    for (const float value : pose.keyframe->imu_bias.gyroscope) add(value);
    for (const float value : pose.keyframe->imu_bias.accelerometer) add(value);
  }
  out += '\n';
}

// Whole nanoseconds of seconds as text, rounded.
std::string NanosecondsText(const detail::PoseText& pose) {
  std::string text = detail::ShiftedDecimal(pose.seconds, 9).value_or("0");
  const std::size_t point = text.find('.');
  if (point == text.npos) return text;
  const auto whole = detail::ParseNumber<std::int64_t>(text.substr(0, point)).value_or(0);
  const bool up = text[point + 1] >= '5';
  return std::to_string(whole + (up ? text.starts_with('-') ? -1 : 1 : 0));
}

void WarnOfUnreachable(std::size_t dropped, std::string_view noun, Notices& notices) {
  if (dropped > 0)
    notices.Warn(
        "left out because their time does not fit into 64 bits of nanoseconds (was it recorded in seconds?): " +
        detail::Counted(dropped, noun));
}

void DropUnreachableTimes(std::vector<detail::KeyFrameTrajectory>& trajectories, Notices& notices) {
  std::size_t dropped = 0;
  for (detail::KeyFrameTrajectory& trajectory : trajectories)
    dropped +=
        std::erase_if(trajectory.poses, [](const detail::TimedPose& pose) { return !FitsNanoseconds(pose.timestamp); });
  std::erase_if(trajectories, [](const detail::KeyFrameTrajectory& trajectory) { return trajectory.poses.empty(); });
  WarnOfUnreachable(dropped, "keyframe", notices);
}

bool IsInertial(const std::vector<detail::KeyFrameTrajectory>& trajectories) {
  return std::any_of(trajectories.begin(), trajectories.end(), [](const detail::KeyFrameTrajectory& trajectory) {
    return std::any_of(trajectory.poses.begin(), trajectory.poses.end(),
                       [](const detail::TimedPose& pose) { return bool{pose.keyframe->imu_calibration.is_set}; });
  });
}

void WriteEuroc(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  DropUnreachableTimes(trajectories.maps, notices);
  const bool inertial = IsInertial(trajectories.maps);
  std::vector<detail::MapLines> maps;
  for (const auto& [map, poses] : trajectories.maps) {
    detail::MapLines& lines = maps.emplace_back(detail::MapLines{map->id, {}});
    for (const detail::TimedPose& pose : poses) AppendLine(lines.lines, pose, inertial);
  }
  const std::string header = std::string(kPoseHeader) + (inertial ? std::string(kInertialHeader) : "") + "\n";
  detail::WriteMapLines(maps, header, trajectories.Count(), target, options, notices);
}

Atlas ReadEuroc(const Source& source, const ReadOptions& options, Notices& notices) {
  return detail::ReadPoses(source, detail::PoseLayout::kEuroc, options, notices);
}

// The names of the columns, which are not those of the IMU and image csv of the same data set; or rows between commas
// that begin with whole nanoseconds since 1970.
bool SniffEuroc(const Probe& probe) {
  static const detail::TableKind names = {.columns = {{{"timestamp"}},
                                                      {{"p_rs_r_x"}},
                                                      {{"p_rs_r_y"}},
                                                      {{"p_rs_r_z"}},
                                                      {{"q_rs_w"}},
                                                      {{"q_rs_x"}},
                                                      {{"q_rs_y"}},
                                                      {{"q_rs_z"}}},
                                          .more_cells = true};
  const detail::TableGlance glance = detail::GlanceAtTable(probe.head, names);
  if (glance.named) return true;
  const bool with_velocity = glance.numbers == 11 || glance.numbers == 17;
  return (glance.numbers == 8 || with_velocity) && glance.separator == ',' && detail::IsEpoch(glance.first * 1e-9);
}

constexpr std::array<std::string_view, 1> kSuffixes = {".euroc.csv"};

}  // namespace

std::size_t detail::WriteEurocText(const TrajectoryText& trajectory, const Target& target, const WriteOptions& options,
                                   Notices& notices) {
  std::vector<MapLines> maps;
  std::size_t dropped = 0, poses = 0;
  for (const MapText& map : trajectory) {
    MapLines& lines = maps.emplace_back(MapLines{map.id, {}});
    for (const PoseText& pose : map.poses) {
      if (!FitsNanoseconds(pose.timestamp)) {
        ++dropped;
        continue;
      }
      lines.lines += NanosecondsText(pose);
      AppendPose(lines.lines, pose);
      lines.lines += '\n';
      ++poses;
    }
  }
  if (poses == 0 && dropped > 0)
    throw Error(ErrorKind::kNotPossible, target.path, "",
                "would hold no poses: no time fits into 64 bits of nanoseconds; nothing was written");
  WarnOfUnreachable(dropped, "pose", notices);
  WriteMapLines(maps, std::string(kPoseHeader) + "\n", {.poses = poses}, target, options, notices);
  return poses;
}

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
