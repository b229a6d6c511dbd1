// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/trajectory/detail/pose_table.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

constexpr std::string_view kHeader = "# timestamp tx ty tz qx qy qz qw\n";

void AppendLine(std::string& out, const detail::PoseText& pose) {
  out += pose.seconds;
  for (const std::string& number : pose.position) out.append(" ").append(number);
  for (const std::string& number : pose.rotation) out.append(" ").append(number);  // x y z w
  out += '\n';
}

void WriteTum(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  std::vector<detail::MapLines> maps;
  for (const auto& [map, poses] : trajectories.maps) {
    detail::MapLines& lines = maps.emplace_back(detail::MapLines{map->id, {}});
    for (const detail::TimedPose& pose : poses) {
      detail::PoseText text;
      detail::AppendSeconds(text.seconds, pose.timestamp);
      detail::SetText(text, pose.world_from_it.translation, pose.world_from_it.rotation);
      AppendLine(lines.lines, text);
    }
  }
  detail::WriteMapLines(maps, kHeader, trajectories.Count(), target, options, notices);
}

Atlas ReadTum(const Source& source, const ReadOptions& options, Notices& notices) {
  return detail::ReadPoses(source, detail::PoseLayout::kTum, options, notices);
}

// Our own table of keyframes names the columns too, and is written only.
bool IsKeyFrameTable(const Probe& probe) { return probe.head.starts_with("map,id,timestamp,frame_id,"); }

// Without names 8 numbers: between blanks, or between commas where the first is no count of nanoseconds since 1970, as
// EuRoC's is, which has them in another order.
bool SniffTum(const Probe& probe) {
  const detail::TableGlance glance = detail::GlanceAtTable(probe.head, detail::PoseTable(detail::PoseLayout::kTum));
  if (glance.named) return !IsKeyFrameTable(probe) && !detail::kEurocFormat.sniff(probe);
  return glance.numbers == 8 && (detail::IsBlank(glance.separator) || !detail::kEurocFormat.sniff(probe));
}

constexpr std::array<std::string_view, 2> kSuffixes = {".tum", ".txt"};

}  // namespace

std::size_t detail::WriteTumText(const TrajectoryText& trajectory, const Target& target, const WriteOptions& options,
                                 Notices& notices) {
  std::vector<MapLines> maps;
  std::size_t poses = 0;
  for (const MapText& map : trajectory) {
    MapLines& lines = maps.emplace_back(MapLines{map.id, {}});
    for (const PoseText& pose : map.poses) AppendLine(lines.lines, pose);
    poses += map.poses.size();
  }
  WriteMapLines(maps, kHeader, {.poses = poses}, target, options, notices);
  return poses;
}

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
