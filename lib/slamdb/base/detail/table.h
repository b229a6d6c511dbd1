// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

// Text tables with named columns, in all dialects that people have; schema/tables.md describes them.
namespace slamdb::detail {

// What a table calls a column: `Latitude [deg]`, `altitude_ft`, `#timestamp`.
struct ColumnName {
  explicit ColumnName(std::string_view text);

  std::string text;  // in lower case, without blanks and quotes around: `latitude [deg]`, `altitude_ft`
  std::string name;  // without the unit: `latitude`, `altitude`
  std::string unit;  // in lower case: `deg`, `ft`; empty when the name states none
};

// A name as it is compared: blanks and dashes in it are as good as `_`, and the slashes of a path as `.`.
std::string Comparable(std::string_view name);

// A column that a reader looks for.
struct Column {
  static constexpr int kOptional = -1;

  // In lower case, the better ones first. One that a point begins is also wanted at the end of a path: `.position.x` is
  // in `field.pose.position.x`.
  std::vector<std::string_view> names;
  int group = 0;                 // a table must have all columns of one group
  std::string_view called = {};  // in errors; empty: the first name
  bool seconds = false;          // of several that differ in their unit, the one in seconds is it
  std::string_view title() const;
};

// What a reader wants of a table.
struct TableKind {
  std::vector<Column> columns;
  std::string expected;          // what a table holds, for errors: `8 numbers: timestamp tx ty tz qx qy qz qw`
  bool by_position = true;       // without names a group's columns stand in the order above
  bool more_cells = false;       // rows may have cells behind those that have names
  bool name_beginnings = false;  // where no column has exactly the name, one that a datum follows is taken: `lat_wgs84`
};

// `47,5`, a number as a spreadsheet writes it in many countries, and the same with a point.
bool IsDecimalComma(std::string_view text);
std::string WithPoint(std::string_view text);

// A cell as it stands in the text, without blanks and quotes around.
struct Cell {
  std::string_view text;
  bool quoted = false;  // quotes in it are written twice
};

// How a table is laid out, as its first lines tell.
struct TableLayout {
  std::vector<ColumnName> names;                   // of the table's columns; empty when no line names them
  std::vector<std::optional<std::size_t>> places;  // of the kind's columns, in a row
  std::size_t needed = 0;                          // cells that a row has at least
  char separator = ' ';                            // of cells; ' ' stands for any run of blanks
  std::vector<std::string_view> comments;          // above the first row
  std::string_view first;                          // the first line that is no comment: names or a row
  std::size_t line = 1;                            // where rows, or those comments, begin
  std::string_view rows;                           // the text from there
  std::string problem;                             // why it is no such table; empty: it is one
  std::string missing;                             // columns that the first line lacks, which names others of a group
  std::size_t named = 0;                           // how many it names
};
// Never throws. The text has no byte order mark.
TableLayout FindLayout(std::string_view text, const TableKind& kind);

// What a format looks at to tell whether a file is its own.
struct TableGlance {
  bool named = false;       // a line names the columns of the kind
  std::size_t numbers = 0;  // cells of the first row, when all are numbers and no line names the columns
  double first = 0;         // the first of them
  char separator = ' ';
};
// Never throws. `head` is the beginning of a file.
TableGlance GlanceAtTable(std::string_view head, const TableKind& kind);

// Reads a table row by row.
// Cells are separated by commas, semicolons, tabs or runs of blanks, whichever the first lines have.
// Lines that `#` or `%` begins are comments, but one above the first row may name the columns.
// Refers to the text, which must outlive it.
class Table {
 public:
  // Reads the names of the columns.
  // Throws Error (kDamaged) with the line when the first line is neither names of the columns nor a row, or two columns
  // go by the same name, and (kUnsupported) when the text is UTF-16.
  Table(std::string_view text, TableKind kind);

  // The names that the table gives its columns, in its order; empty when no line names them.
  const std::vector<ColumnName>& names() const { return layout_.names; }
  // Whether the table has a column of the kind. Columns of a group of which another one is missing are not there.
  bool Has(std::size_t column) const { return layout_.places[column].has_value(); }
  // The name of a column of the kind; null when it is known by its position.
  const ColumnName* NameOf(std::size_t column) const;

  // Goes to the next row, which may span lines when quotes do; false when there is none.
  // Throws Error with the line when the row has too few or too many cells.
  bool Next();

  std::size_t line() const { return line_; }              // of the row, from 1
  std::string_view row() const { return row_; }           // the whole of it
  std::span<const Cell> cells() const { return cells_; }  // all of it
  // The comment lines between the row before and this one; behind the last row those at the end.
  std::span<const std::string_view> comments() const { return comments_; }

  // A cell of the row; empty when its column is not there, or the row ends before.
  std::string_view Raw(std::size_t column) const;
  // The same with quotes that are written twice written once.
  std::string Text(std::size_t column) const;
  // Throws Error naming line and column when the cell is no such number.
  template <class Number>
  Number Get(std::size_t column, std::string_view expected = "a number") const {
    if (const auto number = ParseNumber<Number>(Digits(column))) return *number;
    throw CellError(column, expected);
  }
  // A cell as a number is written everywhere: decimal commas are points, and no plus sign stands in front.
  std::string Digits(std::size_t column) const;
  // The same of a cell by its place in the row, for columns that are not of the kind.
  std::string DigitsAt(std::size_t place) const;
  // Whether a row so far had decimal commas.
  bool has_decimal_commas() const { return decimal_commas_; }

  // `line 12: expected a number, found 'x' in column latitude`.
  Error CellError(std::size_t column, std::string_view expected) const;
  // `line 12: problem`.
  Error LineError(const std::string& problem) const;

 private:
  void CheckCells() const;
  void CheckDecimals();

  TableKind kind_;
  TableLayout layout_;
  std::string_view rest_;
  std::size_t line_ = 0, next_line_ = 1;
  std::string_view row_;
  std::vector<Cell> cells_;
  std::vector<std::string_view> comments_;
  bool decimal_commas_ = false, decimal_points_ = false;
};

}  // namespace slamdb::detail
