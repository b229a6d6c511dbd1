// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table_rows.h"

#include <algorithm>
#include <optional>

#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

std::string_view BlanksOf(char separator) { return separator == '\t' ? " " : " \t"; }

// Lines end with `\n`, `\r\n`, or, where old programs wrote them, with `\r`.
bool IsLineEnd(char letter) { return letter == '\n' || letter == '\r'; }

void SkipLineEnd(std::string_view& text) { text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1); }

void SkipBlanks(std::string_view& text, char separator) {
  text.remove_prefix(std::min(text.find_first_not_of(BlanksOf(separator)), text.size()));
}

bool AtLineEnd(std::string_view text) { return text.empty() || IsLineEnd(text.front()); }

// Where the quote that begins the text is closed; npos when it is not.
std::size_t ClosingQuote(std::string_view text) {
  std::size_t end = text.find('"', 1);
  while (end != std::string_view::npos && end + 1 < text.size() && text[end + 1] == '"') end = text.find('"', end + 2);
  return end;
}

// Takes a quoted cell and the blanks behind it off the text. What begins with a quote but has more than a separator
// behind the closing one is not quoted: `5" pipe`.
std::optional<Cell> TakeQuoted(std::string_view& text, char separator) {
  if (!text.starts_with('"')) return std::nullopt;
  const std::size_t close = ClosingQuote(text);
  if (close == std::string_view::npos) return std::nullopt;
  std::string_view behind = text.substr(close + 1);
  const std::size_t length = behind.size();
  SkipBlanks(behind, separator);
  const bool ends = separator == ' ' ? behind.size() < length : behind.starts_with(separator);
  if (!ends && !AtLineEnd(behind)) return std::nullopt;
  const Cell cell{text.substr(1, close - 1), true};
  text = behind;
  return cell;
}

Cell TakeCell(std::string_view& text, char separator) {
  if (const auto quoted = TakeQuoted(text, separator)) return *quoted;
  const auto ends = [separator](char letter) {
    return IsLineEnd(letter) || letter == separator || (separator == ' ' && letter == '\t');
  };
  std::string_view cell(text.data(), static_cast<std::size_t>(std::ranges::find_if(text, ends) - text.begin()));
  text.remove_prefix(cell.size());
  cell = cell.substr(0, cell.find_last_not_of(BlanksOf(separator)) + 1);
  return {cell};
}

// `sep=;`, by which Excel tells itself.
bool IsSeparatorLine(std::string_view line) { return line.size() == 5 && line.starts_with("sep="); }

bool HasUnquoted(std::string_view line, char separator) {
  bool quoted = false;
  for (const char letter : line) {
    if (letter == '"') quoted = !quoted;
    if (letter == separator && !quoted) return true;
  }
  return false;
}

}  // namespace

std::string_view TakeTableLine(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  text.remove_prefix(line.size());
  SkipLineEnd(text);
  return line;
}

std::size_t LineEndsIn(std::string_view text) {
  std::size_t ends = 0;
  for (std::size_t at = text.find_first_of("\r\n"); at != text.npos; at = text.find_first_of("\r\n")) {
    text.remove_prefix(at);
    SkipLineEnd(text);
    ++ends;
  }
  return ends;
}

std::string_view TakeRow(std::string_view& text, char separator, std::vector<Cell>& cells) {
  const std::string_view all = text;
  cells.clear();
  SkipBlanks(text, separator);
  while (separator != ' ' || !AtLineEnd(text)) {
    cells.push_back(TakeCell(text, separator));
    if (AtLineEnd(text)) break;
    if (separator != ' ') text.remove_prefix(1);
    SkipBlanks(text, separator);
  }
  const std::string_view row = all.substr(0, all.size() - text.size());
  SkipLineEnd(text);
  return row;
}

std::vector<Cell> CellsOf(std::string_view line, char separator) {
  std::vector<Cell> cells;
  TakeRow(line, separator, cells);
  return cells;
}

std::string_view SkipToRow(std::string_view& text, std::size_t& line_number, std::vector<std::string_view>& comments) {
  for (std::string_view behind = text; !text.empty(); text = behind, ++line_number) {
    const std::string_view line = TakeTableLine(behind);
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || IsSeparatorLine(line)) continue;
    if (!IsCommentMark(line[first])) return line;
    comments.push_back(line);
  }
  return {};
}

bool IsNumber(std::string_view text) {
  return ParseNumber<double>(IsDecimalComma(text) ? WithPoint(text) : std::string(text)).has_value();
}

bool AreNumbers(std::span<const Cell> cells) {
  return std::ranges::all_of(cells, [](const Cell& cell) { return IsNumber(cell.text); });
}

// Tabs may separate cells, or be mere blanks: the latter where numbers stand between more of one than of the other.
char SeparatorOf(std::string_view line) {
  if (HasUnquoted(line, ';')) return ';';
  const std::vector<Cell> words = CellsOf(line, ' ');
  const bool numbers = AreNumbers(words);
  // Commas that stand in numbers between blanks are those of decimals.
  if (HasUnquoted(line, ',') && !(numbers && words.size() > 1)) return ',';
  if (!HasUnquoted(line, '\t')) return ' ';
  return numbers && words.size() != CellsOf(line, '\t').size() ? ' ' : '\t';
}

bool IsDecimalComma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == text.npos || comma + 1 == text.size()) return false;
  const std::size_t first = text.front() == '+' || text.front() == '-' ? 1 : 0;
  const auto digits = [](std::string_view part) { return part.find_first_not_of("0123456789") == part.npos; };
  if (comma == first || !digits(text.substr(first, comma - first))) return false;
  const std::string_view behind = text.substr(comma + 1);
  const std::size_t exponent = behind.find_first_of("eE");
  if (exponent == behind.npos) return digits(behind);
  std::string_view power = behind.substr(exponent + 1);
  if (power.starts_with('+') || power.starts_with('-')) power.remove_prefix(1);
  return digits(behind.substr(0, exponent)) && !power.empty() && digits(power);
}

std::string WithPoint(std::string_view text) {
  std::string number(text);
  std::ranges::replace(number, ',', '.');
  return number;
}

}  // namespace slamdb::detail
