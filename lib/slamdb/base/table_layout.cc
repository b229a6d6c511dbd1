// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table_layout.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/table_rows.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/time_unit.h"

namespace slamdb::detail {
namespace {

std::vector<ColumnName> NamesIn(std::string_view line, char separator) {
  const std::vector<Cell> cells = CellsOf(line, separator);
  std::vector<ColumnName> names;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string_view text = cells[i].text;
    // Between blanks a unit in brackets looks like a column of its own.
    while (separator == ' ' && i + 1 < cells.size() &&
           (cells[i + 1].text.starts_with('[') || cells[i + 1].text.starts_with('('))) {
      ++i;
      text = {text.data(), static_cast<std::size_t>(cells[i].text.data() + cells[i].text.size() - text.data())};
    }
    names.emplace_back(text);
  }
  return names;
}

// Whether a name stands for a column. `.position.x` is wanted at the end of a path too: `field.pose.position.x`.
bool Stands(std::string_view name, std::string_view wanted) {
  if (!wanted.starts_with('.')) return name == wanted;
  return name == wanted.substr(1) || (name.size() > wanted.size() && name.ends_with(wanted));
}

// What may stand behind a name without making it another thing, as `lat_std` and `time_since_start` are.
bool IsDatum(std::string_view behind) {
  static constexpr std::string_view kData[] = {"wgs84", "gps", "gnss", "ellipsoid", "ellipsoidal", "hae"};
  return !behind.empty() && (behind.front() == '_' || behind.front() == ' ') &&
         std::ranges::find(kData, behind.substr(1)) != std::end(kData);
}

// Which names stand for a column: the better ones first, each exactly, or without its unit, or at the end of a path;
// or else by its beginning.
std::vector<std::size_t> Matches(const std::vector<ColumnName>& names, const Column& column, bool beginnings) {
  const auto matching = [&](const auto& matches) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (matches(names[i])) found.push_back(i);
    return found;
  };
  for (const std::string_view wanted : column.names) {
    auto found = matching([&](const ColumnName& name) { return Stands(Comparable(name.text), wanted); });
    if (found.empty()) found = matching([&](const ColumnName& name) { return Stands(Comparable(name.name), wanted); });
    if (!found.empty()) return found;
  }
  for (std::string_view wanted : beginnings ? column.names : std::vector<std::string_view>()) {
    if (wanted.starts_with('.')) wanted.remove_prefix(1);
    if (auto found = matching([&](const ColumnName& name) {
          return name.name.starts_with(wanted) && IsDatum(std::string_view(name.name).substr(wanted.size()));
        });
        !found.empty())
      return found;
  }
  return {};
}

// Of `time_s` and `time_ns` the first.
void PreferSeconds(const std::vector<ColumnName>& names, std::vector<std::size_t>& matches) {
  const auto in_seconds = [&](std::size_t i) { return TimeUnitByName(names[i].unit) == TimeUnit::kSeconds; };
  if (std::ranges::count_if(matches, in_seconds) == 1) matches = {*std::ranges::find_if(matches, in_seconds)};
}

using Places = std::vector<std::optional<std::size_t>>;

// Leaves out the columns of groups that are not whole; false when no group is.
bool KeepWholeGroups(const std::vector<Column>& columns, Places& places) {
  bool groups = false, whole_group = false;
  for (const Column& column : columns) {
    if (column.group == Column::kOptional) continue;
    groups = true;
    bool whole = true;
    for (std::size_t i = 0; i < columns.size(); ++i) whole &= columns[i].group != column.group || places[i];
    for (std::size_t i = 0; i < columns.size() && !whole; ++i)
      if (columns[i].group == column.group) places[i].reset();
    whole_group |= whole;
  }
  return whole_group || !groups;
}

std::size_t CellsNeeded(const std::vector<Column>& columns, const Places& places) {
  std::size_t needed = 0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].group != Column::kOptional && places[i]) needed = std::max(needed, *places[i] + 1);
  return needed;
}

// Finds the columns by the names in a line. False when the line does not name them; two columns of one name are a
// problem of the layout.
bool TakeNames(std::string_view line, const TableKind& kind, TableLayout& layout) {
  const char separator = SeparatorOf(line);
  std::vector<ColumnName> names = NamesIn(line, separator);
  Places places(kind.columns.size());
  std::string problem;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::vector<std::size_t> matches = Matches(names, kind.columns[i], kind.name_beginnings);
    if (kind.columns[i].seconds) PreferSeconds(names, matches);
    if (matches.size() > 1)
      problem =
          Concat("columns ", matches[0] + 1, " and ", matches[1] + 1, " are both named ", kind.columns[i].title());
    if (!matches.empty()) places[i] = matches[0];
  }
  if (!KeepWholeGroups(kind.columns, places)) return false;
  layout.needed = CellsNeeded(kind.columns, places);
  layout.names = std::move(names);
  layout.places = std::move(places);
  layout.separator = separator;
  layout.problem = std::move(problem);
  return true;
}

// The separator of rows, the first of which begins `text`, under names with a separator.
char SeparatorOfRows(std::string_view text, char of_names) {
  return of_names != ' ' && CellsOf(text, of_names).size() > 1 ? of_names : SeparatorOf(TakeTableLine(text));
}

// Finds the columns in the comments above the first row.
bool FindNamesInComments(const TableKind& kind, TableLayout& layout) {
  if (kind.columns.empty()) return false;
  for (std::string_view comment : layout.comments) {
    TableLayout named;
    comment.remove_prefix(std::min(comment.find_first_not_of("#% \t"), comment.size()));
    // In prose the words that are names do not stand where the cells are.
    if (!TakeNames(comment, kind, named) || !named.problem.empty()) continue;
    const char separator = SeparatorOfRows(layout.rows, named.separator);
    if (!layout.first.empty() && named.needed > CellsOf(layout.first, separator).size()) continue;
    layout.names = std::move(named.names);
    layout.places = std::move(named.places);
    layout.needed = named.needed;
    layout.separator = separator;
    return true;
  }
  return false;
}

// Gives the columns of the first group that a row of so many cells has their places.
bool TakePositions(std::span<const Cell> row, const TableKind& kind, TableLayout& layout) {
  // The first is a number, or a date.
  if (!kind.by_position || row.empty()) return false;
  if (!IsNumber(row[0].text) && (row[0].text.empty() || row[0].text[0] < '0' || row[0].text[0] > '9')) return false;
  const auto filled = [&] { return row.back().text.empty() ? row.size() - 1 : row.size(); }();
  for (const Column& column : kind.columns) {
    std::size_t size = 0;
    for (const Column& other : kind.columns) size += other.group == column.group;
    if (column.group == Column::kOptional || !(filled == size || (kind.more_cells && filled > size))) continue;
    for (std::size_t i = 0, place = 0; i < kind.columns.size(); ++i)
      if (kind.columns[i].group == column.group) layout.places[i] = place++;
    layout.needed = size;
    return true;
  }
  return false;
}

// Notes which columns a line lacks that names some of a group, so that they are not searched for by eye.
void NoteMissing(const std::vector<Cell>& row, const TableKind& kind, TableLayout& layout) {
  if (std::ranges::any_of(row, [](const Cell& cell) { return IsNumber(cell.text); })) return;
  std::vector<ColumnName> names;
  for (const Cell& cell : row) names.emplace_back(cell.text);
  std::string missing;
  for (const Column& column : kind.columns) {
    if (column.group != 0 || column.names.empty()) continue;
    if (!Matches(names, column, kind.name_beginnings).empty())
      ++layout.named;
    else
      missing += Concat(missing.empty() ? "" : ", ", column.title());
  }
  if (layout.named > 0) layout.missing = std::move(missing);
}

}  // namespace

std::string_view Column::title() const {
  const std::string_view name = called.empty() ? names[0] : called;
  return name.substr(name.starts_with('.') ? 1 : 0);
}

TableLayout FindLayout(std::string_view text, const TableKind& kind) {
  TableLayout layout{.places = Places(kind.columns.size())};
  layout.first = SkipToRow(text, layout.line, layout.comments);
  layout.rows = text;
  if (layout.first.empty()) {
    FindNamesInComments(kind, layout);
    return layout;
  }
  if (TakeNames(layout.first, kind, layout)) {
    TakeTableLine(layout.rows);
    ++layout.line;
    std::vector<std::string_view> comments;
    std::size_t line = layout.line;
    text = layout.rows;
    SkipToRow(text, line, comments);
    layout.separator = SeparatorOfRows(text, layout.separator);
    return layout;
  }
  const std::vector<Cell> row = CellsOf(layout.first, layout.separator = SeparatorOf(layout.first));
  if (FindNamesInComments(kind, layout) || TakePositions(row, kind, layout)) return layout;
  NoteMissing(row, kind, layout);
  layout.problem = "expected " + kind.expected + ", found " + Excerpt(layout.first);
  if (!layout.missing.empty()) layout.problem += ", in which no column is named " + layout.missing;
  return layout;
}

TableGlance GlanceAtTable(std::string_view head, const TableKind& kind) {
  if (IsUtf16(head)) return {};
  const TableLayout layout = FindLayout(WithoutMark(head), kind);
  if (!layout.names.empty()) return {.named = true, .separator = layout.separator};
  std::vector<Cell> row = CellsOf(layout.first, layout.separator);
  if (row.size() > 1 && row.back().text.empty()) row.pop_back();  // a separator behind the last cell
  if (row.empty() || !AreNumbers(row)) return {.separator = layout.separator};
  const auto first = ParseNumber<double>(WithPoint(row[0].text));
  return {.numbers = row.size(), .first = first.value_or(0), .separator = layout.separator};
}

}  // namespace slamdb::detail
