// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/number.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/lines.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

constexpr std::string_view kSeparators = " \t";

void AppendLine(std::string& out, const TimedPose& pose) {
  AppendSeconds(out, pose.timestamp);
  const auto add = [&out](float value) {
    out += ' ';
    AppendNumber(out, value);
  };
  for (const float value : pose.world_from_it.translation) add(value);
  for (const float value : pose.world_from_it.rotation.coeffs()) add(value);  // x y z w
  out += '\n';
}

void WriteTum(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const std::vector<MapTrajectory> trajectories = CollectTrajectories(atlas, target, options, notices);
  std::vector<const Map*> maps;
  for (const MapTrajectory& trajectory : trajectories) maps.push_back(trajectory.map);
  WarnOfSeveralFrames(maps, "lines `# map N` tell them apart", notices);
  file.Write("# timestamp tx ty tz qx qy qz qw\n");
  for (const auto& [map, poses] : trajectories) {
    if (trajectories.size() > 1) file.Write(MapComment(map->id));
    std::string lines;
    for (const TimedPose& pose : poses) AppendLine(lines, pose);
    file.Write(lines);
  }
  file.Commit();
}

std::optional<ReadPose> PoseOf(const PoseLine& line) {
  const auto timestamp = ParseNumber(line.time);
  const auto v = line.values;
  if (!timestamp || v.size() != 7) return std::nullopt;
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  return ReadPose{*timestamp, {Quaternionf(rotation.cast<float>()), Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()}};
}

Atlas ReadTum(const Source& source, const ReadOptions& options, Notices&) {
  return ReadPoseLines(source, options, kSeparators, "8 numbers: timestamp tx ty tz qx qy qz qw", PoseOf);
}

bool SniffTum(const Probe& probe) { return NumbersInFirstLine(probe, kSeparators) == 8; }

constexpr std::array<std::string_view, 2> kSuffixes = {".tum", ".txt"};

}  // namespace

const Format kTumFormat = {.id = "tum",
                           .title = "TUM trajectory",
                           .suffixes = kSuffixes,
                           .reads = Content::kPoses | Content::kMaps,
                           .writes = Content::kPoses | Content::kMaps,
                           .sniff = SniffTum,
                           .read = ReadTum,
                           .write = WriteTum};

}  // namespace slamdb
