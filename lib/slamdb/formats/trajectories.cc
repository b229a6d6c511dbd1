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

detail::TrajectoryText Read(const Location& location, const ReadOptions& options, Notices& notices) {
  const Source source(location.path, location.name);
  const Format& format = detail::FormatToRead(source, options);
  return detail::ReadTrajectoryText(source, Require(format, location.path).layout, options, notices);
}

}  // namespace

bool IsTrajectory(const Format& format) { return TextFormatOf(format) != nullptr; }

std::vector<TrajectoryPose> ReadTrajectory(const Location& location, const ReadOptions& options, Notices* notices) {
  Notices unheard;
  detail::TrajectoryText maps = Read(location, options, notices == nullptr ? unheard : *notices);
  std::erase_if(maps, [](const detail::MapText& map) { return map.poses.empty(); });
  if (maps.size() != 1)
    throw Error(ErrorKind::kNotPossible, location.path, "",
                detail::Concat("must hold one trajectory, not ", maps.size()));
  std::vector<TrajectoryPose> poses;
  for (const detail::PoseText& pose : maps[0].poses)
    poses.push_back({pose.timestamp, pose.translation, pose.quaternion});
  return poses;
}

TrajectorySize ConvertTrajectory(const Location& input, const Location& output, const ReadOptions& read,
                                 const WriteOptions& write, Notices* notices) {
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  const Target target(output.path, output.name);
  const TextFormat& format = Require(detail::FormatToWrite(target, write), output.path);
  detail::TrajectoryText maps = Read(input, read, heard);
  detail::Select(maps, read.selection);
  format.write(maps, target, write, heard);
  TrajectorySize size{.maps = maps.size()};
  for (const detail::MapText& map : maps) size.poses += map.poses.size();
  return size;
}

}  // namespace slamdb
