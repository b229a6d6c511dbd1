// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/table.h"
#include "slamdb/base/notices.h"

// Columns that hold N and S, or E and W, whatever they are called: without them half of the earth is mirrored.
namespace slamdb::detail {

// Latitude or longitude in a kind of tables.
struct Coordinate {
  std::size_t column;        // of its degrees
  std::size_t hemisphere;    // the column of its hemisphere, by name
  std::string_view letters;  // NS, EW
  std::string_view title;
};

// The place in a row of a column that has a name.
std::size_t PlaceOf(const Table& table, std::size_t column);

// What the cells of a column that are not empty have in common.
struct ColumnContents {
  std::string letters;  // HemisphereOf them, each once
  bool numbers = true;  // all are
  double greatest = 0;  // of the numbers above 0
};
// Of the columns that have names, by their places in a row. Reads the whole text where there are any.
// Throws Error as Table.
std::vector<ColumnContents> ContentsOfColumns(std::string_view text, const TableKind& kind);

// The place in a row of a coordinate's hemisphere: of the column that has a name of it, or else of one whose cells are
// all such letters or words, or empty; a note says so. Nothing when there is none. Numbers under a name that has other
// meanings too are none (`ns`, the number of satellites).
// Throws Error when several columns may be meant, or one stands where none is expected and would mirror places.
std::optional<std::size_t> FindHemisphere(const Table& table, const TableKind& kind,
                                          const std::vector<ColumnContents>& contents, const Coordinate& coordinate,
                                          Notices& notices);

// The letter of `n`, `South`, ...; ' ' when the cell is empty or none of the letters.
char HemisphereOf(std::string_view cell, std::string_view letters = "NSEW");

}  // namespace slamdb::detail
