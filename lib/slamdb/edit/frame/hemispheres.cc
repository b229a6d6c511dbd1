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

// What the cells of a column have in common.
struct Contents {
  bool letters = true;  // of the coordinate
  bool numbers = true;
  bool any = false;      // one is not empty
  bool mirrors = false;  // one is S or W
};

std::vector<Contents> ContentsOfColumns(std::string_view text, const TableKind& kind, const Coordinate& coordinate) {
  Table table(text, kind);
  std::vector<Contents> columns(table.names().size());
  while (table.Next())
    for (std::size_t i = 0; i < std::min(columns.size(), table.cells().size()); ++i) {
      const std::string_view cell = table.cells()[i].text;
      if (cell.empty()) continue;
      const char letter = HemisphereOf(cell, coordinate);
      columns[i].any = true;
      columns[i].letters &= letter != ' ';
      columns[i].mirrors |= letter == coordinate.letters[1];
      columns[i].numbers &= ParseNumber<double>(cell).has_value();
    }
  return columns;
}

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

std::size_t PlaceOf(const Table& table, std::size_t column) {
  return static_cast<std::size_t>(table.NameOf(column) - table.names().data());
}

Error Uncertain(const std::string& problem, const Coordinate& coordinate) {
  return Error(ErrorKind::kNotPossible, "", "",
               Concat(problem, "; name the column of the ", coordinate.title, "'s hemisphere ", coordinate.letters[0],
                      '/', coordinate.letters[1], ", and that of where something heads heading"));
}

}  // namespace

char HemisphereOf(std::string_view cell, const Coordinate& coordinate) {
  static constexpr std::array<std::string_view, 4> kWords = {"NORTH", "SOUTH", "EAST", "WEST"};
  std::string upper(cell);
  for (char& letter : upper)
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  if (upper.empty() || coordinate.letters.find(upper[0]) == coordinate.letters.npos) return ' ';
  return upper.size() == 1 || std::ranges::find(kWords, upper) != kWords.end() ? upper[0] : ' ';
}

std::optional<std::size_t> FindHemisphere(std::string_view text, const TableKind& kind, const Coordinate& coordinate,
                                          Notices& notices) {
  const Table table(text, kind);
  if (table.names().empty()) return std::nullopt;
  const std::vector<Contents> contents = ContentsOfColumns(text, kind, coordinate);
  std::vector<bool> taken(contents.size());
  for (std::size_t column = 0; column < kind.columns.size(); ++column)
    if (table.Has(column)) taken[PlaceOf(table, column)] = true;
  if (table.Has(coordinate.hemisphere)) {
    const std::size_t place = PlaceOf(table, coordinate.hemisphere);
    const bool counts = table.names()[place].text.size() == 2 && contents[place].any && contents[place].numbers;
    if (!counts) return place;
  }
  const std::size_t degrees = PlaceOf(table, coordinate.column);
  std::vector<std::size_t> meant, others;
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const std::string name = Comparable(table.names()[i].text);
    if (taken[i] || !contents[i].any || !contents[i].letters || IsHeading(name)) continue;
    const bool beside = i == degrees + 1 || i + 1 == degrees;
    (beside || NamesHemisphere(name, coordinate) ? meant : others).push_back(i);
  }
  const auto shown = [&](std::size_t place) { return Concat('\'', table.names()[place].text, '\''); };
  const std::string letters = Concat(coordinate.letters[0], " and ", coordinate.letters[1]);
  if (meant.size() > 1)
    throw Uncertain(Concat("the columns ", shown(meant[0]), " and ", shown(meant[1]), " both hold ", letters),
                    coordinate);
  if (meant.empty()) {
    const auto other = std::ranges::find_if(others, [&](std::size_t place) { return contents[place].mirrors; });
    if (other != others.end()) throw Uncertain(Concat("the column ", shown(*other), " holds ", letters), coordinate);
    return std::nullopt;
  }
  notices.Note(Concat("the column ", shown(meant[0]), " is taken for the hemisphere of the ", coordinate.title,
                      ", since it holds ", letters));
  return meant[0];
}

}  // namespace slamdb::detail
