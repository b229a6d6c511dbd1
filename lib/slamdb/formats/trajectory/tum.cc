// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/lines.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

using detail::AppendNumber;
using detail::AppendSeconds;

const detail::TableKind& Kind() {
  static const detail::TableKind kind = {
      .columns = {{{"timestamp", "time", "t"}}, {{"tx"}}, {{"ty"}}, {{"tz"}}, {{"qx"}}, {{"qy"}}, {{"qz"}}, {{"qw"}}},
      .expected = "8 numbers: timestamp tx ty tz qx qy qz qw"};
  return kind;
}

void AppendLine(std::string& out, const detail::TimedPose& pose) {
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
  AtomicFile file(target, detail::FileOptions(options));
  const detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  std::vector<const Map*> maps;
  for (const detail::MapTrajectory& trajectory : trajectories.maps) maps.push_back(trajectory.map);
  detail::WarnOfSeveralFrames(maps, "lines `# map N` tell them apart", notices);
  file.Write("# timestamp tx ty tz qx qy qz qw\n");
  for (const auto& [map, poses] : trajectories.maps) {
    if (trajectories.maps.size() > 1) file.Write(detail::MapComment(map->id));
    std::string lines;
    for (const detail::TimedPose& pose : poses) AppendLine(lines, pose);
    file.Write(lines);
  }
  file.Commit();
  notices.Tell(trajectories.Summary());
}

detail::ReadPose PoseOf(const detail::Table& table) {
  const double timestamp = table.Get<double>(0);
  const auto v = detail::NumbersBehindTime(table);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  return {timestamp, {Quaternionf(rotation.cast<float>()), Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()}};
}

Atlas ReadTum(const Source& source, const ReadOptions& options, Notices&) {
  return detail::ReadPoses(source, options, Kind(), PoseOf);
}

// Without names only 8 numbers between blanks: between commas they may also be EuRoC's, in another order.
bool SniffTum(const Probe& probe) {
  const detail::TableGlance glance = detail::GlanceAtTable(probe.head, Kind());
  return glance.named || (glance.numbers == 8 && detail::IsBlank(glance.separator));
}

constexpr std::array<std::string_view, 2> kSuffixes = {".tum", ".txt"};

}  // namespace

const Format detail::kTumFormat = {.id = "tum",
                                   .title = "TUM trajectory",
                                   .suffixes = kSuffixes,
                                   .chooses_maps = true,
                                   .is_export = true,
                                   .reads = Content::kPoses | Content::kMaps,
                                   .writes = Content::kPoses | Content::kMaps,
                                   .sniff = SniffTum,
                                   .read = ReadTum,
                                   .write = WriteTum};

}  // namespace slamdb
