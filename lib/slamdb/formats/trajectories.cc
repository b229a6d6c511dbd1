// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectories.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/detail/dry_run.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"
#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb {
namespace {

struct TextFormat {
  std::string_view id;
  detail::PoseLayout layout;
  detail::WriteText write;
};

const TextFormat* TextFormatOf(const Format& format) {
  static constexpr std::array kFormats = {
      TextFormat{"tum", detail::PoseLayout::kTum, detail::WriteTumText},
      TextFormat{"euroc", detail::PoseLayout::kEuroc, detail::WriteEurocText},
      TextFormat{"kitti", detail::PoseLayout::kKitti, detail::WriteKittiText},
  };
  const auto found = std::ranges::find(kFormats, format.id, &TextFormat::id);
  return found == kFormats.end() ? nullptr : &*found;
}

const TextFormat& Require(const Format& format, const std::string& path) {
  const TextFormat* text = TextFormatOf(format);
  if (text == nullptr) throw Error(ErrorKind::kUsage, path, "", "is no trajectory");
  return *text;
}

detail::TrajectoryText Read(const HeldSource& held, const ReadOptions& options, Notices& notices) {
  const Source& source = held.source();
  const Format& format = detail::FormatToRead(source, options);
  return detail::ReadTrajectoryText(source, Require(format, source.path).layout, options, notices);
}

// The number that a file tells: of a float the shortest decimal, of which a double holds more digits.
double AsWritten(float value) {
  std::string digits;
  detail::AppendNumber(digits, value);
  return detail::ParseNumber<double>(digits).value_or(value);
}

std::size_t CountPoses(const detail::TrajectoryText& maps) {
  std::size_t poses = 0;
  for (const detail::MapText& map : maps) poses += map.poses.size();
  return poses;
}

// An empty selection is no success.
void SelectSome(detail::TrajectoryText& maps, const Selection& selection, const std::string& path) {
  if (selection.map && std::ranges::find(maps, *selection.map, &detail::MapText::id) == maps.end())
    throw Error(ErrorKind::kNotFound, path, "", detail::Concat("has no map ", selection.map->value()));
  const std::size_t before = CountPoses(maps);
  detail::Select(maps, selection);
  if (before > 0 && maps.empty()) throw Error(ErrorKind::kNotFound, path, "", "has no poses in the range");
}

}  // namespace

bool IsTrajectory(const Format& format) { return TextFormatOf(format) != nullptr; }

std::vector<TrajectoryPose> ReadTrajectory(const Location& location, const ReadOptions& options, Notices* notices) {
  return ReadTrajectory(HoldInput(location, options), options, notices);
}

std::vector<TrajectoryPose> ReadTrajectory(const HeldSource& held, const ReadOptions& options, Notices* notices) {
  std::vector<MapTrajectory> maps = ReadTrajectories(held, options, notices);
  if (maps.size() != 1)
    throw Error(ErrorKind::kNotPossible, held.source().path, "",
                detail::Concat("must hold one trajectory, not ", maps.size()));
  return std::move(maps.front().poses);
}

std::vector<MapTrajectory> ReadTrajectories(const HeldSource& held, const ReadOptions& options, Notices* notices) {
  Notices unheard;
  std::vector<MapTrajectory> maps;
  for (const detail::MapText& text : Read(held, options, notices == nullptr ? unheard : *notices)) {
    if (text.poses.empty()) continue;
    MapTrajectory& map = maps.emplace_back(MapTrajectory{.map = text.id, .poses = {}});
    map.poses.reserve(text.poses.size());
    for (const detail::PoseText& pose : text.poses)
      map.poses.push_back({pose.timestamp, pose.translation, pose.quaternion});
  }
  return maps;
}

std::vector<MapTrajectory> TrajectoriesOf(const Atlas& atlas, PoseFrame frame, Notices* notices) {
  Notices unheard;
  WriteOptions options;
  options.of<TrajectoryOptions>().pose_frame = frame;
  std::vector<MapTrajectory> maps;
  for (const detail::KeyFrameTrajectory& trajectory :
       detail::CollectTrajectories(atlas, Target(""), options, notices == nullptr ? unheard : *notices).maps) {
    MapTrajectory& map = maps.emplace_back(MapTrajectory{.map = trajectory.map->id, .poses = {}});
    map.poses.reserve(trajectory.poses.size());
    for (const detail::TimedPose& pose : trajectory.poses) {
      const Eigen::Vector4d rotation = pose.world_from_it.rotation.coeffs().unaryExpr(&AsWritten);
      map.poses.push_back({pose.timestamp, pose.world_from_it.translation.unaryExpr(&AsWritten),
                           Eigen::Quaterniond(rotation).normalized()});
    }
  }
  return maps;
}

std::size_t ConvertTrajectory(const Location& input, const Location& output, const ReadOptions& read,
                              const WriteOptions& write, Notices* notices) {
  return ConvertTrajectory(HoldInput(input, read), output, read, write, notices);
}

std::size_t ConvertTrajectory(const HeldSource& held, const Location& output, const ReadOptions& read,
                              const WriteOptions& write, Notices* notices) {
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  const Target target(output.path, output.name);
  const TextFormat& format = Require(detail::FormatToWrite(target, write), output.path);
  detail::TrajectoryText maps = Read(held, read, heard);
  SelectSome(maps, read.selection, held.source().path);
  return format.write(maps, detail::TargetOf(target, write), write, heard);
}

}  // namespace slamdb
