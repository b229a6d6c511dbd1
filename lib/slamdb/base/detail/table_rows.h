// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Lines, rows and cells of a table's text.
namespace slamdb::detail {

// A cell as it stands in the text, without blanks and quotes around.
struct Cell {
  std::string_view text;
  bool quoted = false;  // quotes in it are written twice
};

// Takes the first line off a text, without its line end: `\n`, `\r\n`, or, where old programs wrote it, `\r`.
std::string_view TakeTableLine(std::string_view& text);
std::size_t LineEndsIn(std::string_view text);

// Takes a row with its line end off the text and returns it without.
std::string_view TakeRow(std::string_view& text, char separator, std::vector<Cell>& cells);
std::vector<Cell> CellsOf(std::string_view line, char separator);

// Goes to the first line that is neither blank nor a comment, and returns it; empty when there is none.
std::string_view SkipToRow(std::string_view& text, std::size_t& line_number, std::vector<std::string_view>& comments);

bool IsNumber(std::string_view text);
bool AreNumbers(std::span<const Cell> cells);

// Of the cells in a line; ' ' stands for any run of blanks.
char SeparatorOf(std::string_view line);

// `47,5` and `4,75e+01`, numbers as spreadsheets write them in many countries, and the same with a point.
bool IsDecimalComma(std::string_view text);
std::string WithPoint(std::string_view text);

}  // namespace slamdb::detail
