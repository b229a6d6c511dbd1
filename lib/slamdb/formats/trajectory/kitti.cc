// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/table.h"
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

void AppendLine(std::string& out, const Rigid3f& pose) {
  const Eigen::Matrix3f rotation = pose.rotation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      AppendNumber(out, rotation(row, column));
      out += ' ';
    }
    AppendNumber(out, pose.translation[row]);
    out += row < 2 ? ' ' : '\n';
  }
}

// `lines 1-46 are map 0, lines 47-106 map 1`: readers of this format take no comments, so the warning has to say it.
std::string LinesOfMaps(const std::vector<detail::MapTrajectory>& trajectories) {
  std::string text;
  std::size_t line = 1;
  for (const detail::MapTrajectory& trajectory : trajectories) {
    const std::size_t last = line + trajectory.poses.size() - 1;
    text += detail::Concat(text.empty() ? "lines " : ", lines ", line, "-", last, " are ", trajectory.map->id);
    line = last + 1;
  }
  return text;
}

void WriteKitti(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, detail::FileOptions(options));
  const std::string times_path = target.path + ".times";
  std::optional<AtomicFile> times;
  if (target.is_file()) times.emplace(times_path, detail::FileOptions(options));
  const detail::Trajectories trajectories = detail::CollectTrajectories(atlas, target, options, notices);
  std::vector<const Map*> maps;
  for (const detail::MapTrajectory& trajectory : trajectories.maps) maps.push_back(trajectory.map);
  detail::WarnOfSeveralFrames(maps, LinesOfMaps(trajectories.maps), notices);
  if (!times)
    notices.Warn(detail::Concat("kitti has no timestamps in its lines, and ",
                                target.sink ? target.path : "standard output", " has no second file for them"));
  for (const auto& [map, poses] : trajectories.maps) {
    std::string lines, seconds;
    for (const detail::TimedPose& pose : poses) {
      AppendLine(lines, pose.world_from_it);
      AppendSeconds(seconds, pose.timestamp);
      seconds += '\n';
    }
    file.Write(lines);
    if (times) times->Write(seconds);
  }
  if (times) times->Commit();
  file.Commit();
  notices.Tell(trajectories.Summary() + (times ? "; their times are in " + times_path : std::string()));
}

bool SniffKitti(const Probe& probe) {
  const detail::TableGlance glance = detail::GlanceAtTable(probe.head, {.columns = std::vector<detail::Column>(12)});
  return glance.numbers == 12 && detail::IsBlank(glance.separator);
}

constexpr std::array<std::string_view, 1> kSuffixes = {".kitti"};

}  // namespace

const Format detail::kKittiFormat = {.id = "kitti",
                                     .title = "KITTI trajectory",
                                     .suffixes = kSuffixes,
                                     .chooses_maps = true,
                                     .is_export = true,
                                     .writes = Content::kPoses,
                                     .sniff = SniffKitti,
                                     .write = WriteKitti};

}  // namespace slamdb
