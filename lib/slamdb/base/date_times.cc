// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/date_times.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

std::optional<std::int64_t> DigitsAt(std::string_view& text, std::size_t least, std::size_t most) {
  const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  if (count < least || count > most) return std::nullopt;
  const auto number = ParseNumber<std::int64_t>(text.substr(0, count));
  text.remove_prefix(count);
  return number;
}

bool TakeOneOf(std::string_view& text, std::string_view letters) {
  if (text.empty() || letters.find(text.front()) == letters.npos) return false;
  text.remove_prefix(1);
  return true;
}

// `2023-11-14` or `2023/11/14`: days since 1970.
std::optional<std::int64_t> TakeDay(std::string_view& text) {
  const auto year = DigitsAt(text, 4, 4);
  if (!year || !TakeOneOf(text, "-/.")) return std::nullopt;
  const auto month = DigitsAt(text, 1, 2);
  if (!month || !TakeOneOf(text, "-/.")) return std::nullopt;
  const auto day = DigitsAt(text, 1, 2);
  if (!day) return std::nullopt;
  return DaysTo(static_cast<int>(*year), static_cast<int>(*month), static_cast<int>(*day));
}

struct TimeOfDay {
  std::int64_t seconds = 0;
  std::string_view fraction;  // digits behind the point
};

// `22:13:20.25`.
std::optional<TimeOfDay> TakeTimeOfDay(std::string_view& text) {
  const auto hour = DigitsAt(text, 1, 2);
  if (!hour || !TakeOneOf(text, ":")) return std::nullopt;
  const auto minute = DigitsAt(text, 2, 2);
  if (!minute || !TakeOneOf(text, ":")) return std::nullopt;
  const auto second = DigitsAt(text, 2, 2);
  if (!second || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  TimeOfDay time{*hour * 3600 + *minute * 60 + *second, {}};
  if (!TakeOneOf(text, ".,")) return time;
  time.fraction = text.substr(0, text.find_first_not_of("0123456789"));
  text.remove_prefix(time.fraction.size());
  return time;
}

// `Z`, `UTC`, `+02:00`, `+0200`: seconds to take away; nothing at the end of the text means no zone.
std::optional<std::int64_t> TakeZone(std::string_view text) {
  text = Trimmed(text);
  if (text == "Z" || text == "z" || text == "UTC" || text == "GMT") return 0;
  const int sign = text.starts_with('-') ? -1 : 1;
  if (!TakeOneOf(text, "+-")) return std::nullopt;
  const auto hour = DigitsAt(text, 2, text.find(':') == text.npos ? 4 : 2);
  if (!hour) return std::nullopt;
  if (*hour >= 100) return text.empty() ? std::optional(sign * (*hour / 100 * 3600 + *hour % 100 * 60)) : std::nullopt;
  if (!TakeOneOf(text, ":")) return text.empty() ? std::optional(sign * *hour * 3600) : std::nullopt;
  const auto minute = DigitsAt(text, 2, 2);
  return minute && text.empty() ? std::optional(sign * (*hour * 3600 + *minute * 60)) : std::nullopt;
}

}  // namespace

std::optional<std::int64_t> DaysTo(int year, int month, int day) {
  const std::chrono::year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
}

std::string SecondsText(std::int64_t seconds, std::string_view fraction) {
  return fraction.empty() ? std::to_string(seconds) : Concat(seconds, '.', fraction);
}

std::optional<DateTime> ParseDateTime(std::string_view text, std::string_view date) {
  const bool apart = !date.empty();
  const auto day = TakeDay(apart ? date : text);
  if (!day || (apart ? !date.empty() : !TakeOneOf(text, "Tt _"))) return std::nullopt;
  const auto time = TakeTimeOfDay(text);
  if (!time) return std::nullopt;
  const bool has_zone = !Trimmed(text).empty();
  const auto zone = has_zone ? TakeZone(text) : 0;
  if (!zone) return std::nullopt;
  return DateTime{SecondsText(*day * 86400 + time->seconds - *zone, time->fraction), has_zone};
}

std::optional<std::string> DateTimeText(double seconds) {
  constexpr double kFirst = -62135596800, kEnd = 253402300800;  // of the year 1, of the year 9999
  if (!(seconds >= kFirst && seconds < kEnd)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(std::floor(seconds));
  const std::chrono::sys_seconds time{std::chrono::seconds(whole)};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  std::string fraction;
  // Of times before 1970 the digits are of what is missing to the next second, so they are those of the difference.
  AppendSeconds(fraction, seconds < 0 ? seconds - static_cast<double>(whole) : seconds);
  const std::size_t point = fraction.find('.');
  const auto digits = [](std::int64_t number, std::size_t count) {
    std::string text = std::to_string(number);
    return std::string(count - std::min(count, text.size()), '0') + text;
  };
  return Concat(digits(static_cast<int>(date.year()), 4), '-', digits(static_cast<unsigned>(date.month()), 2), '-',
                digits(static_cast<unsigned>(date.day()), 2), 'T', digits(clock.hours().count(), 2), ':',
                digits(clock.minutes().count(), 2), ':', digits(clock.seconds().count(), 2),
                point == fraction.npos ? "" : fraction.substr(point), 'Z');
}

bool IsTimeOfDay(std::string_view text) { return TakeTimeOfDay(text).has_value(); }

}  // namespace slamdb::detail
