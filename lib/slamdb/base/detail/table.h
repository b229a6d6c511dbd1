// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/column_name.h"
#include "slamdb/base/detail/table_layout.h"
#include "slamdb/base/detail/table_rows.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

// Text tables with named columns, in all dialects that people have; schema/tables.md describes them.
namespace slamdb::detail {

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
