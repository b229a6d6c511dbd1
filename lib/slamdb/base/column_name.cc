// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/column_name.h"

#include <algorithm>
#include <iterator>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/time_unit.h"

namespace slamdb::detail {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& letter : lower)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return lower;
}

bool IsUnit(std::string_view word) {
  static constexpr std::string_view kOthers[] = {"min",     "minutes", "h",       "hours", "days", "deg",
                                                 "degs",    "degree",  "degrees", "rad",   "rads", "radian",
                                                 "radians", "e6",      "dege6",   "e7",    "dege7"};
  return TimeUnitByName(word) || MetresByName(word) || std::ranges::find(kOthers, word) != std::end(kOthers);
}

// `us` for `\u00b5s` and `\u03bcs`, the two letters that people write.
std::string WithoutMicro(std::string_view unit) {
  for (const std::string_view micro : {"\xc2\xb5", "\xce\xbc", "\xce\x9c"})
    if (unit.starts_with(micro)) return Concat('u', unit.substr(micro.size()));
  return std::string(unit);
}

// Where the unit begins in `UnixTimeMillis`, `latitudeE7` and `TimeUS`; npos: nowhere.
std::size_t CamelUnit(std::string_view shown) {
  const auto is_lower = [](char letter) { return letter >= 'a' && letter <= 'z'; };
  const auto is_upper = [](char letter) { return letter >= 'A' && letter <= 'Z'; };
  for (std::size_t at = shown.size(); at-- > 1;)
    if (is_lower(shown[at - 1]) && is_upper(shown[at])) return IsUnit(Lower(shown.substr(at))) ? at : shown.npos;
  return shown.npos;
}

}  // namespace

std::string Comparable(std::string_view name) {
  std::string text(name);
  for (char& letter : text) letter = letter == ' ' || letter == '-' ? '_' : letter == '/' ? '.' : letter;
  return text.starts_with('.') ? text.substr(1) : text;
}

ColumnName::ColumnName(std::string_view shown) : text(Lower(shown)), name(text) {
  const std::size_t bracket = text.find_last_of("[(");
  if (bracket != text.npos && bracket > 0 && (text.back() == ']' || text.back() == ')')) {
    unit = WithoutMicro(Trimmed(std::string_view(text).substr(bracket + 1, text.size() - bracket - 2)));
    name = Trimmed(std::string_view(text).substr(0, bracket));
    if (name.ends_with('_')) name.pop_back();
    return;
  }
  if (IsUnit(text) && text.size() > 2) unit = text;  // `seconds`, `nanoseconds`
  if (const std::size_t at = CamelUnit(shown); at != shown.npos) {
    name = text.substr(0, at);
    unit = text.substr(at);
    return;
  }
  const std::size_t end = text.find_last_of("_ -");
  if (end == text.npos || end == 0 || !IsUnit(WithoutMicro(std::string_view(text).substr(end + 1)))) return;
  unit = WithoutMicro(std::string_view(text).substr(end + 1));
  name = Trimmed(std::string_view(text).substr(0, end));
}

}  // namespace slamdb::detail
