// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/amounts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {

std::string Rounded(double amount) {
  constexpr double kGroups = 9999.5, kMost = 1e15;  // between, four digits would be written with an exponent
  const double size = std::abs(amount);
  if (!(size >= kGroups && size < kMost)) return Digits(amount + 0.0, 4);  // no -0
  return Concat(amount < 0 ? "-" : "", Thousands(static_cast<std::uint64_t>(size + 0.5)));
}

std::string LengthText(double length, std::string_view unit) { return Concat(Rounded(length), ' ', unit); }

std::string DurationText(double seconds) {
  constexpr double kMinute = 59.95, kMost = 1e15;                     // from 59.95 on three digits would say 60 s
  if (!(seconds >= kMinute)) return Digits(seconds + 0.0, 3) + " s";  // no -0
  const auto whole = static_cast<std::uint64_t>(std::min(seconds, kMost) + 0.5);
  if (whole < 3600) return Concat(whole / 60, " min ", whole % 60, " s");
  return Concat(Thousands(whole / 3600), " h ", whole % 3600 / 60, " min");
}

std::string HumanBytes(std::uint64_t bytes) {
  if (bytes < 1000) return Concat(bytes, " B");
  constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB", "PB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 999.5 && unit + 1 < kUnits.size(); ++unit) amount /= 1000;
  return Concat(Fixed(amount, amount < 99.95 ? 1 : 0), ' ', kUnits[unit]);
}

std::string DateText(double seconds) {
  constexpr double kEarliest = 631152000, kLatest = 4102444800;  // 1990 and 2100: recordings of real cameras
  if (!(seconds >= kEarliest && seconds < kLatest)) return {};
  const std::string date = *DateTimeText(std::floor(seconds));  // 2014-06-24T19:02:59Z
  return Concat(date.substr(0, 10), ' ', date.substr(11, 8), " UTC");
}

std::string SecondsText(double seconds) {
  constexpr double kNoTime = 1e15;  // which would only be long
  if (std::abs(seconds) >= kNoTime) return Digits(seconds);
  std::string text;
  AppendSeconds(text, seconds);
  return text;
}

std::string DatedDuration(double begin, double end) {
  const std::string date = DateText(begin);
  return DurationText(end - begin) + (date.empty() ? "" : " from " + date);
}

}  // namespace slamdb::detail
