// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/export.h"

// Dates and times of day as text.
namespace slamdb::detail {

// Days from 1970 to a date; nothing when there is no such day.
std::optional<std::int64_t> DaysTo(int year, int month, int day);

// Whole seconds and the digits behind their point, if there are any.
std::string SecondsText(std::int64_t seconds, std::string_view fraction);

struct DateTime {
  std::string seconds;  // since 1970
  bool has_zone = false;
};

// `2023-11-14T22:13:20.25Z`, or with a blank between; the day may stand in another cell.
SLAMDB_EXPORT std::optional<DateTime> ParseDateTime(std::string_view text, std::string_view date);

// `2023-11-14T22:13:20.25Z` of seconds since 1970, with all their digits; nothing outside the years 1 to 9999.
SLAMDB_EXPORT std::optional<std::string> DateTimeText(double seconds);

// Whether the text begins with the time of a day, `22:13:20`.
bool IsTimeOfDay(std::string_view text);

}  // namespace slamdb::detail
