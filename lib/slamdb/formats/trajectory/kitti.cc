// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <filesystem>

#include "slamdb/base/atomic_folder.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/detail/dry_run.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

using detail::AppendNumber;
using detail::AppendSeconds;

template <class Scalar>
void AppendLine(std::string& out, const Eigen::Matrix<Scalar, 3, 3>& rotation,
                const std::array<std::string, 3>& translation) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      AppendNumber(out, rotation(row, column));
      out += ' ';
    }
    out += translation[static_cast<std::size_t>(row)];
    out += row < 2 ? ' ' : '\n';
  }
}

// The poses of one map, and the times of them.
struct Lines {
  MapId map;
  std::size_t count = 0;
  std::string poses, seconds;
};

// `lines 1-46 are map 0, lines 47-106 map 1`: readers of this format take no comments, so the warning has to say it.
std::string LinesOfMaps(const std::vector<Lines>& maps) {
  std::string text;
  std::size_t line = 1;
  for (const Lines& lines : maps) {
    const std::size_t last = line + lines.count - 1;
    text += detail::Concat(text.empty() ? "lines " : ", lines ", line, "-", last, " are ", lines.map);
    line = last + 1;
  }
  return text;
}

void WriteTo(AtomicFile& file, const std::vector<Lines>& maps, std::string Lines::*text) {
  for (const Lines& lines : maps) file.Write(lines.*text);
}

// Poses alone do not say when.
// Returns where the times are.
std::string WriteTogether(const std::vector<Lines>& maps, const Target& target, const WriteOptions& options) {
  AtomicFiles files(target, detail::FileOptions(options));
  const std::string times = files.target() + ".times";
  const auto seconds = files.Make(std::filesystem::path(times).filename().string()), poses = files.MakeTarget();
  WriteTo(*seconds, maps, &Lines::seconds);
  WriteTo(*poses, maps, &Lines::poses);
  seconds->Commit();
  poses->Commit();
  files.Commit();
  return times;
}

void WriteLines(const std::vector<Lines>& maps, const detail::PoseCount& count, const Target& target,
                const WriteOptions& options, Notices& notices) {
  detail::WarnOfSeveralFrames(maps.size(), LinesOfMaps(maps), notices);
  const WrittenCounts written{.keyframes = count.poses};
  if (detail::HasFile(target, options) && !IsSpecialFile(target.path)) {
    const std::string times = WriteTogether(maps, target, options);
    return notices.Tell(count.Summary() + "; their times are in " + times, written);
  }
  notices.Warn(detail::Concat("kitti has no timestamps in its lines, and ",
                              target.sink ? target.path : "standard output", " has no second file for them"));
  AtomicFile file(target, detail::FileOptions(options));
  WriteTo(file, maps, &Lines::poses);
  file.Commit();
  notices.Tell(count.Summary(), written);
}

void WriteKitti(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  std::vector<Lines> maps;
  for (const auto& [map, poses] : trajectories.maps) {
    Lines& lines = maps.emplace_back(Lines{map->id, poses.size(), {}, {}});
    for (const detail::TimedPose& pose : poses) {
      detail::PoseText text;
      detail::SetText(text, pose.world_from_it.translation, pose.world_from_it.rotation);
      AppendLine<float>(lines.poses, pose.world_from_it.rotation.toRotationMatrix(), text.position);
      AppendSeconds(lines.seconds, pose.timestamp);
      lines.seconds += '\n';
    }
  }
  WriteLines(maps, trajectories.Count(), target, options, notices);
}

Atlas ReadKitti(const Source& source, const ReadOptions& options, Notices& notices) {
  return detail::ReadPoses(source, detail::PoseLayout::kKitti, options, notices);
}

bool SniffKitti(const Probe& probe) {
  const detail::TableGlance glance = detail::GlanceAtTable(probe.head, {.columns = std::vector<detail::Column>(12)});
  return glance.numbers == 12;
}

constexpr std::array<std::string_view, 1> kSuffixes = {".kitti"};

}  // namespace

std::size_t detail::WriteKittiText(const TrajectoryText& trajectory, const Target& target, const WriteOptions& options,
                                   Notices& notices) {
  std::vector<Lines> maps;
  std::size_t poses = 0;
  for (const MapText& map : trajectory) {
    Lines& lines = maps.emplace_back(Lines{map.id, map.poses.size(), {}, {}});
    poses += map.poses.size();
    for (const PoseText& pose : map.poses) {
      AppendLine<double>(lines.poses, pose.quaternion.toRotationMatrix(), pose.position);
      lines.seconds.append(pose.seconds).append("\n");
    }
  }
  WriteLines(maps, {.poses = poses}, target, options, notices);
  return poses;
}

const Format detail::kKittiFormat = {.id = "kitti",
                                     .title = "KITTI trajectory",
                                     .suffixes = kSuffixes,
                                     .chooses_maps = true,
                                     .is_export = true,
                                     .reads = Content::kPoses,
                                     .writes = Content::kPoses,
                                     .sniff = SniffKitti,
                                     .read = ReadKitti,
                                     .write = WriteKitti};

}  // namespace slamdb
