// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>

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

std::string HumanBytes(std::uint64_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " B";
  constexpr std::array<const char*, 6> kUnits = {" B", " kB", " MB", " GB", " TB", " PB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (amount >= 999.5 && unit + 1 < kUnits.size()) {
    amount /= 1000;
    ++unit;
  }
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), amount, std::chars_format::fixed, amount < 99.95 ? 1 : 0);
  return std::string(text.data(), end) + kUnits[unit];
}

std::string Percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0 || part == 0) return "0%";
  const double percent = 100 * static_cast<double>(part) / static_cast<double>(whole);
  return percent < 1 ? "< 1%" : std::to_string(static_cast<int>(percent + 0.5)) + "%";
}

std::string DurationText(double seconds) {
  if (seconds < 60) return Short(seconds, 3) + " s";
  const auto whole = static_cast<std::uint64_t>(seconds + 0.5);
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return Grouped(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string DateText(double seconds) {
  constexpr double kEarliest = 631152000, kLatest = 4102444800;  // 1990 and 2100: recordings of real cameras
  if (!(seconds >= kEarliest && seconds < kLatest)) return {};
  const auto whole = static_cast<std::int64_t>(seconds);
  const std::chrono::year_month_day day(std::chrono::sys_days(std::chrono::days(whole / 86400)));
  const auto two = [](std::uint64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  const auto of_day = static_cast<std::uint64_t>(whole % 86400);
  return detail::Concat(static_cast<int>(day.year()), "-", two(static_cast<unsigned>(day.month())), "-",
                        two(static_cast<unsigned>(day.day())), " ", two(of_day / 3600), ":", two(of_day % 3600 / 60),
                        ":", two(of_day % 60), " UTC");
}

std::string DatedDuration(double begin, double end) {
  const std::string date = DateText(begin);
  return DurationText(end - begin) + (date.empty() ? "" : " from " + date);
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

std::string Table::ToString() const {
  std::vector<std::size_t> widths(columns_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size() && c < widths.size(); ++c) widths[c] = std::max(widths[c], Columns(row[c]));
  std::string out;
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
