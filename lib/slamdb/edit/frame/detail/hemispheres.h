// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

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

// The place in a row of a coordinate's hemisphere: of the column that has a name of it, or else of one whose cells are
// all such letters or words, or empty; a note says so. Nothing when there is none. Numbers under a name that has other
// meanings too are none (`ns`, the number of satellites).
// Throws Error when several columns may be meant, or one stands where none is expected and would mirror places.
std::optional<std::size_t> FindHemisphere(std::string_view text, const TableKind& kind, const Coordinate& coordinate,
                                          Notices& notices);

// The letter of `n`, `South`, ...; ' ' when the cell is empty or none of the coordinate's.
char HemisphereOf(std::string_view cell, const Coordinate& coordinate);

}  // namespace slamdb::detail
