// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "slamdb/export.h"

// How slamdb reads and writes plain text: lines, cells, numbers. Tables with columns are table.h's.
// Nothing here depends on a locale.
namespace slamdb::detail {

inline constexpr std::string_view kBlanks = " \t";
inline bool IsBlank(char letter) { return kBlanks.find(letter) != std::string_view::npos; }

// The text behind the byte order mark of UTF-8, if it has one.
// Throws Error (kUnsupported) when the mark is one of UTF-16.
SLAMDB_EXPORT std::string_view WithoutMark(std::string_view text);

// Whether the text has a byte order mark of UTF-16, so that its letters are not bytes.
SLAMDB_EXPORT bool IsUtf16(std::string_view text);

// Takes the first line off a text, without its line end, which is `\n` or `\r\n`. The last line may have none.
inline std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// Takes the first word off a text: what stands between characters of `separators`. Empty when none is left.
inline std::string_view TakeWord(std::string_view& text, std::string_view separators) {
  text.remove_prefix(std::min(text.find_first_not_of(separators), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(separators));
  text.remove_prefix(word.size());
  return word;
}

// What stands before, between and behind the separators; one more than there are of them.
inline std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

// Without blanks at its ends.
inline std::string_view Trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// What begins a line that is a comment.
inline bool IsCommentMark(char letter) { return letter == '#' || letter == '%'; }

// A decimal number that fills the whole text; nothing when it does not, or when the type cannot hold it.
// A plus sign is allowed, and nan and inf are where the type has them. Integers do not go through a double.
template <class Number>
std::optional<Number> ParseNumber(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// The beginning of a line for an error: `found ...`, in backquotes.
SLAMDB_EXPORT std::string Excerpt(std::string_view line);

// Numbers appended to a text with the fewest digits that read back to the same bits.
// Not-a-number is `nan` whatever its sign and payload, infinities are `inf` and `-inf`.
SLAMDB_EXPORT void AppendNumber(std::string& out, float value);
SLAMDB_EXPORT void AppendNumber(std::string& out, double value);
SLAMDB_EXPORT void AppendNumber(std::string& out, std::uint64_t value);
SLAMDB_EXPORT void AppendNumber(std::string& out, std::int64_t value);
template <std::integral Integer>
void AppendNumber(std::string& out, Integer value) {
  using Wide = std::conditional_t<std::is_signed_v<Integer>, std::int64_t, std::uint64_t>;
  AppendNumber(out, static_cast<Wide>(value));
}

// Seconds: as AppendNumber, but never with an exponent, because readers of trajectories expect none.
SLAMDB_EXPORT void AppendSeconds(std::string& out, double seconds);

}  // namespace slamdb::detail
