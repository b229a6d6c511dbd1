// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/detail/hemispheres.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/detail/concat.h"

namespace slamdb::detail {
namespace {

bool HasAnyOf(std::string_view name, std::span<const std::string_view> parts) {
  return std::ranges::any_of(parts, [&](std::string_view part) { return name.find(part) != name.npos; });
}

// Where a receiver goes, looks or was sent is not where it is.
bool IsHeading(std::string_view name) {
  static constexpr std::array<std::string_view, 11> kHeadings = {
      "heading", "course", "bearing", "_wind", "compass", "facing", "azimuth", "yaw", "track", "dest", "magvar"};
  return HasAnyOf(Concat('_', name), kHeadings);  // but `ewindicator`
}

bool NamesHemisphere(std::string_view name, const Coordinate& coordinate) {
  static constexpr std::array<std::string_view, 8> kNorthSouth = {"lat",  "north", "south", "hemi",
                                                                  "nors", "_ns_",  "_n_s_", "_n.s_"};
  static constexpr std::array<std::string_view, 9> kEastWest = {"lon",  "lng",  "east",  "west", "hemi",
                                                                "eorw", "_ew_", "_e_w_", "_e.w_"};
  const std::string marked = Concat('_', name, '_');
  return coordinate.letters == "NS" ? HasAnyOf(marked, kNorthSouth) : HasAnyOf(marked, kEastWest);
}

bool HoldsOnly(const ColumnContents& contents, const Coordinate& coordinate) {
  return !contents.letters.empty() && contents.letters.find_first_not_of(coordinate.letters) == std::string::npos;
}

// Whether a cell is S or W.
bool Mirrors(const ColumnContents& contents, const Coordinate& coordinate) {
  return contents.letters.find(coordinate.letters[1]) != std::string::npos;
}

Error Uncertain(const std::string& problem, const Coordinate& coordinate) {
  return Error(ErrorKind::kNotPossible, "", "",
               Concat(problem, "; name the column of the ", coordinate.title, "'s hemisphere ", coordinate.letters[0],
                      '/', coordinate.letters[1], ", and that of where something heads heading"));
}

}  // namespace

std::size_t PlaceOf(const Table& table, std::size_t column) {
  return static_cast<std::size_t>(table.NameOf(column) - table.names().data());
}

char HemisphereOf(std::string_view cell, std::string_view letters) {
  static constexpr std::array<std::string_view, 4> kWords = {"NORTH", "SOUTH", "EAST", "WEST"};
  std::string upper(cell);
  for (char& letter : upper)
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  if (upper.empty() || letters.find(upper[0]) == letters.npos) return ' ';
  return upper.size() == 1 || std::ranges::find(kWords, upper) != kWords.end() ? upper[0] : ' ';
}

std::vector<ColumnContents> ContentsOfColumns(std::string_view text, const TableKind& kind) {
  Table table(text, kind);
  std::vector<ColumnContents> columns(table.names().size());
  while (!columns.empty() && table.Next())
    for (std::size_t i = 0; i < std::min(columns.size(), table.cells().size()); ++i) {
      const std::string_view cell = table.cells()[i].text;
      if (cell.empty()) continue;
      const char letter = HemisphereOf(cell);
      if (columns[i].letters.find(letter) == std::string::npos) columns[i].letters += letter;
      const auto number = ParseNumber<double>(cell);
      columns[i].numbers &= number.has_value();
      columns[i].greatest = std::max(columns[i].greatest, number.value_or(0));
    }
  return columns;
}

std::optional<std::size_t> FindHemisphere(const Table& table, const TableKind& kind,
                                          const std::vector<ColumnContents>& contents, const Coordinate& coordinate,
                                          Notices& notices) {
  if (table.names().empty()) return std::nullopt;
  std::vector<bool> taken(contents.size());
  for (std::size_t column = 0; column < kind.columns.size(); ++column)
    if (table.Has(column)) taken[PlaceOf(table, column)] = true;
  if (table.Has(coordinate.hemisphere)) {
    const std::size_t place = PlaceOf(table, coordinate.hemisphere);
    const bool counts =
        table.names()[place].text.size() == 2 && !contents[place].letters.empty() && contents[place].numbers;
    if (!counts) return place;
  }
  const std::size_t degrees = PlaceOf(table, coordinate.column);
  std::vector<std::size_t> meant, others;
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const std::string name = Comparable(table.names()[i].text);
    if (taken[i] || !HoldsOnly(contents[i], coordinate) || IsHeading(name)) continue;
    const bool beside = i == degrees + 1 || i + 1 == degrees;
    (beside || NamesHemisphere(name, coordinate) ? meant : others).push_back(i);
  }
  const auto shown = [&](std::size_t place) { return Concat('\'', table.names()[place].text, '\''); };
  const std::string letters = Concat(coordinate.letters[0], " and ", coordinate.letters[1]);
  if (meant.size() > 1)
    throw Uncertain(Concat("the columns ", shown(meant[0]), " and ", shown(meant[1]), " both hold ", letters),
                    coordinate);
  if (meant.empty()) {
    const auto other =
        std::ranges::find_if(others, [&](std::size_t place) { return Mirrors(contents[place], coordinate); });
    if (other != others.end()) throw Uncertain(Concat("the column ", shown(*other), " holds ", letters), coordinate);
    return std::nullopt;
  }
  notices.Note(Concat("the column ", shown(meant[0]), " is taken for the hemisphere of the ", coordinate.title,
                      ", since it holds ", letters));
  return meant[0];
}

}  // namespace slamdb::detail
