// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"

// The little that tables of ids and anchors need of CSV. Private to the folder.
namespace slamdb {

// Takes the first line off `text`, without its line end.
std::string_view TakeLine(std::string_view& text);

// The cells of a line as they stand there, quotes included.
void SplitCells(std::string_view line, std::vector<std::string_view>& cells);

// `line 12: problem`.
Error LineError(std::size_t line, const std::string& problem);

// A cell that is a number and nothing else.
template <class Number>
std::optional<Number> ParseCell(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace slamdb
