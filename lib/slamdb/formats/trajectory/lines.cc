// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/lines.h"

#include <charconv>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/number.h"

namespace slamdb {
namespace {

constexpr std::string_view kMapComment = "# map ";

// Takes one line off the front of a text, without its line end.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> Cells(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;
       begin = line.find_first_not_of(separators, begin)) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return cells;
}

bool IsComment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string_view::npos || line[first] == '#';
}

template <class Number>
std::optional<Number> Parse(std::string_view text) {
  Number value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<MapId> MapOfComment(std::string_view line) {
  if (!line.starts_with(kMapComment)) return std::nullopt;
  const auto id = Parse<std::uint64_t>(line.substr(kMapComment.size()));
  return id ? std::optional(MapId(*id)) : std::nullopt;
}

}  // namespace

std::optional<double> ParseNumber(std::string_view text) { return Parse<double>(text); }
std::optional<std::int64_t> ParseInteger(std::string_view text) { return Parse<std::int64_t>(text); }

Atlas ReadPoseLines(const Source& source, const ReadOptions& options, std::string_view separators,
                    const std::string& expected, const std::function<std::optional<ReadPose>(const PoseLine&)>& pose) {
  const MappedFile file(source);
  std::string_view text = file.text();
  PoseAtlas atlas;
  std::vector<double> values;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = TakeLine(text);
    if (const auto map = MapOfComment(line)) atlas.BeginMap(*map);
    if (IsComment(line)) continue;
    const std::vector<std::string_view> cells = Cells(line, separators);
    values.clear();
    bool numbers = !cells.empty();
    for (std::size_t cell = 1; numbers && cell < cells.size(); ++cell) {
      const auto value = ParseNumber(cells[cell]);
      numbers = value.has_value();
      if (numbers) values.push_back(*value);
    }
    const auto read = numbers ? pose({cells[0], values}) : std::nullopt;
    if (!read)
      throw Error(ErrorKind::kDamaged, source.path, "line " + std::to_string(number),
                  "expected " + expected + ", found `" + std::string(line.substr(0, 80)) + "`");
    atlas.Add(read->timestamp, read->world_from_camera);
  }
  return atlas.Finish(options);
}

std::size_t NumbersInFirstLine(const Probe& probe, std::string_view separators) {
  std::string_view text = probe.head;
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    if (IsComment(line)) continue;
    const std::vector<std::string_view> cells = Cells(line, separators);
    for (const std::string_view cell : cells)
      if (!ParseNumber(cell)) return 0;
    return cells.size();
  }
  return 0;
}

std::string MapComment(MapId id) {
  std::string line(kMapComment);
  AppendNumber(line, id.value());
  return line + '\n';
}

}  // namespace slamdb
