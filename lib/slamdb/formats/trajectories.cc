// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectories.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"

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
  Notices unheard;
  detail::TrajectoryText maps = Read(held, options, notices == nullptr ? unheard : *notices);
  std::erase_if(maps, [](const detail::MapText& map) { return map.poses.empty(); });
  if (maps.size() != 1)
    throw Error(ErrorKind::kNotPossible, held.source().path, "",
                detail::Concat("must hold one trajectory, not ", maps.size()));
  std::vector<TrajectoryPose> poses;
  for (const detail::PoseText& pose : maps[0].poses)
    poses.push_back({pose.timestamp, pose.translation, pose.quaternion});
  return poses;
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
  return format.write(maps, target, write, heard);
}

}  // namespace slamdb
