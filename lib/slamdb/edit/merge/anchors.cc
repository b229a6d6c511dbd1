// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/anchors.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "slamdb/base/detail/csv_cells.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, 2> kKeyFrameColumns = {"first", "second"};
constexpr std::array<std::string_view, 6> kPlaceColumns = {"first_x",  "first_y",  "first_z",
                                                           "second_x", "second_y", "second_z"};

// Where the columns of these names are; nothing when one is missing.
template <std::size_t count>
std::optional<std::array<std::size_t, count>> Find(const std::vector<std::string_view>& header,
                                                   const std::array<std::string_view, count>& names) {
  std::array<std::size_t, count> columns;
  for (std::size_t i = 0; i < count; ++i) {
    columns[i] = static_cast<std::size_t>(std::ranges::find(header, names[i]) - header.begin());
    if (columns[i] == header.size()) return std::nullopt;
  }
  return columns;
}

// The numbers in these columns; nothing when all cells are empty.
template <class Number, std::size_t count>
std::optional<std::array<Number, count>> Read(const std::vector<std::string_view>& cells,
                                              const std::array<std::size_t, count>& columns, std::size_t line) {
  if (std::ranges::all_of(columns, [&](std::size_t column) { return cells[column].empty(); })) return std::nullopt;
  std::array<Number, count> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = ParseCell<Number>(cells[columns[i]]);
    if (!number) throw LineError(line, "expected a number, found '" + std::string(cells[columns[i]]) + "'");
    numbers[i] = *number;
  }
  return numbers;
}

}  // namespace

Anchors ParseAnchors(std::string_view text) {
  Anchors anchors;
  std::vector<std::string_view> pairs;
  SplitCells(text, pairs);
  for (const std::string_view pair : pairs) {
    const std::size_t colon = std::min(pair.find(':'), pair.size());
    const auto first = ParseCell<std::uint64_t>(pair.substr(0, colon));
    const auto second = ParseCell<std::uint64_t>(pair.substr(std::min(colon + 1, pair.size())));
    if (!first || !second)
      throw Error("expected pairs of keyframes as FIRST:SECOND,..., or a file, found '" + std::string(text) + "'");
    anchors.keyframes.push_back({KeyFrameId(*first), KeyFrameId(*second)});
  }
  return anchors;
}

Anchors ParseAnchorsCsv(std::string_view csv) {
  Anchors anchors;
  std::vector<std::string_view> cells;
  SplitCells(TakeLine(csv), cells);
  const std::size_t width = cells.size();
  const auto keyframe_columns = Find(cells, kKeyFrameColumns);
  const auto place_columns = Find(cells, kPlaceColumns);
  if (!keyframe_columns && !place_columns)
    throw LineError(1,
                    "expected the columns first,second of keyframes, or first_x,first_y,first_z,second_x,second_y,"
                    "second_z of places");
  for (std::size_t line = 2; !csv.empty(); ++line) {
    const std::string_view text = TakeLine(csv);
    if (text.empty()) continue;
    SplitCells(text, cells);
    if (cells.size() != width)
      throw LineError(line, "expected " + std::to_string(width) + " cells, found " + std::to_string(cells.size()));
    if (keyframe_columns)
      if (const auto ids = Read<std::uint64_t>(cells, *keyframe_columns, line))
        anchors.keyframes.push_back({KeyFrameId((*ids)[0]), KeyFrameId((*ids)[1])});
    if (place_columns)
      if (const auto x = Read<double>(cells, *place_columns, line))
        anchors.places.push_back({{(*x)[0], (*x)[1], (*x)[2]}, {(*x)[3], (*x)[4], (*x)[5]}});
  }
  return anchors;
}

}  // namespace slamdb
