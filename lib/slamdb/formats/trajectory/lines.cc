// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/lines.h"

#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kMapComment = "# map ";

std::optional<MapId> MapOfComment(std::string_view line) {
  if (!line.starts_with(kMapComment)) return std::nullopt;
  const auto id = ParseNumber<std::uint64_t>(Trimmed(line.substr(kMapComment.size())));
  return id ? std::optional(MapId(*id)) : std::nullopt;
}

PoseAtlas ParsePoses(std::string_view text, const TableKind& kind, const std::function<ReadPose(const Table&)>& pose) {
  PoseAtlas atlas;
  Table table(text, kind);
  for (bool more = true; more;) {
    more = table.Next();
    for (const std::string_view comment : table.comments())
      if (const auto map = MapOfComment(comment)) atlas.BeginMap(*map);
    if (!more) break;
    const ReadPose read = pose(table);
    atlas.Add(read.timestamp, read.world_from_camera);
  }
  return atlas;
}

}  // namespace

Atlas ReadPoses(const Source& source, const ReadOptions& options, const TableKind& kind,
                const std::function<ReadPose(const Table&)>& pose) {
  return ParseFile(source, "a trajectory", [&](std::string_view text) { return ParsePoses(text, kind, pose); })
      .Finish(options);
}

std::array<double, 7> NumbersBehindTime(const Table& table) {
  std::array<double, 7> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = table.Get<double>(i + 1);
  return numbers;
}

std::string MapComment(MapId id) {
  std::string line(kMapComment);
  AppendNumber(line, id.value());
  return line + '\n';
}

}  // namespace slamdb::detail
