// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/layout.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/visible.h"

namespace slamdb::cli {
namespace {

// Columns that a UTF-8 text takes, one per code point.
std::size_t Columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string WrappedParagraph(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out, line;
  const auto finish = [&] {
    if (!line.empty()) out += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  for (auto word = detail::TakeWord(text, " \n"); !word.empty(); word = detail::TakeWord(text, " \n")) {
    if (!line.empty() && indent + Columns(line) + 1 + Columns(word) > width) finish();
    if (!line.empty()) line += ' ';
    line += word;
  }
  finish();
  return out;
}

}  // namespace

std::string Grouped(std::uint64_t number) { return detail::Thousands(number); }

std::string Counted(std::uint64_t number, std::string_view one, std::string_view many) {
  std::string text = Grouped(number).append(" ").append(number == 1 || many.empty() ? one : many);
  if (number != 1 && many.empty()) text += 's';
  return text;
}

std::string Short(double number, int digits) {
  std::array<char, 64> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), number + 0.0, std::chars_format::general, digits);  // no -0
  return std::string(text.data(), end);
}

std::string Percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0 || part == 0) return "0%";
  const double percent = 100 * static_cast<double>(part) / static_cast<double>(whole);
  return percent < 1 ? "< 1%" : std::to_string(static_cast<int>(percent + 0.5)) + "%";
}

std::string Wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out;
  std::string paragraph;
  const auto finish = [&] {
    out += WrappedParagraph(paragraph, indent, width);
    paragraph.clear();
  };
  while (!text.empty()) {
    const std::string_view line = detail::TakeLine(text);
    if (line.empty() || line.front() == ' ') {
      finish();
      out += line.empty() ? "\n" : std::string(indent, ' ') + std::string(line) + "\n";
    } else {
      paragraph += std::string(line) + "\n";
    }
  }
  finish();
  return out;
}

void Table::Add(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = detail::Visible(cell);
  rows_.push_back(std::move(cells));
}

void Table::Drop(std::size_t column) {
  const auto place = static_cast<std::ptrdiff_t>(column);
  columns_.erase(columns_.begin() + place);
  for (auto& row : rows_) row.erase(row.begin() + place);
}

std::size_t Table::WidthOf(std::size_t column) const {
  std::size_t width = 0;
  for (const auto& row : rows_)
    if (column < row.size()) width = std::max(width, Columns(row[column]));
  return width;
}

void Table::Shorten(std::size_t column, std::size_t width) {
  constexpr std::string_view kCut = "...";
  for (auto& row : rows_) {
    std::string_view end = row[column];
    if (Columns(end) <= width) continue;
    while (!end.empty() && Columns(end) + kCut.size() > width) end.remove_prefix(1);
    while (!end.empty() && (end.front() & 0xC0) == 0x80) end.remove_prefix(1);  // not within a letter
    row[column] = std::string(kCut).append(end);
  }
}

std::string Table::ToString() const {
  std::vector<std::size_t> widths(columns_.size());
  std::size_t width = indent_ + 1;
  for (std::size_t c = 0; c < widths.size(); ++c) width += 2 + (widths[c] = WidthOf(c));
  std::string out;
  out.reserve(rows_.size() * width);
  for (const auto& row : rows_) {
    std::string line(indent_, ' ');
    for (std::size_t c = 0; c < row.size() && c < widths.size(); ++c) {
      const std::string padding(widths[c] - Columns(row[c]), ' ');
      if (c > 0) line += "  ";
      line += columns_[c] == Align::kRight ? padding + row[c] : row[c] + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

}  // namespace slamdb::cli
