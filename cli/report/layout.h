// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/amounts.h"

namespace slamdb::cli {

using detail::DatedDuration;
using detail::DateText;
using detail::DurationText;
using detail::HumanBytes;
using detail::LengthText;
using detail::Rounded;

inline constexpr std::size_t kPageWidth = 96;  // columns of text for people

// 1234567 -> "1,234,567".
std::string Grouped(std::uint64_t number);

// "1 map", "3 maps", with the number grouped.
std::string Counted(std::uint64_t number, std::string_view one, std::string_view many = {});

// "39%", "< 1%".
std::string Percent(std::uint64_t part, std::uint64_t whole);

// A number in at most `digits` significant digits, without trailing zeros and locale.
std::string Short(double number, int digits = 4);

// Breaks text into lines of at most `width` columns, each after `indent` spaces; an empty line separates paragraphs.
// Lines that start with a space are kept as they are. Ends with a line feed unless the text is empty.
std::string Wrapped(std::string_view text, std::size_t indent = 0, std::size_t width = kPageWidth);

// Rows of cells in aligned columns, two spaces apart.
class Table {
 public:
  enum class Align { kLeft, kRight };

  explicit Table(std::vector<Align> columns, std::size_t indent = 0) : columns_(std::move(columns)), indent_(indent) {}
  // Names in cells may be any: what would steer a terminal is escaped.
  void Add(std::vector<std::string> cells);
  std::size_t WidthOf(std::size_t column) const;
  void Shorten(std::size_t column, std::size_t width);  // of longer cells the end is kept, behind "..."
  void Drop(std::size_t column);                        // leaves out a column that says nothing here
  bool empty() const { return rows_.empty(); }
  std::string ToString() const;

 private:
  std::vector<Align> columns_;
  std::size_t indent_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace slamdb::cli
