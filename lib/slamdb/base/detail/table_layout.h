// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/column_name.h"

// Which columns a table has and how its cells are separated.
namespace slamdb::detail {

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

}  // namespace slamdb::detail
