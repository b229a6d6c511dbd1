// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"

// Times of day as receivers write them into tables: `190259.764` for 19:02:59.764, perhaps with `240614` for a date.
namespace slamdb::detail {

struct ClockTimes {
  std::span<const std::string> times;  // numbers, a row each
  std::span<const std::string> dates;  // as many, or none where no column has them
  std::string_view date_order;         // what the column of the dates says of them: `ddmmyy`; empty: nothing
  bool stated = false;                 // the column of the times says that they are hhmmss
  std::size_t first_line = 0;          // of the rows
};

// Seconds since 1970, or since midnight where there are no dates, with a note. Nothing when the times are not hhmmss,
// which all of them must be, and which the dates, a leading zero or a jump from one minute to the next must show: what
// lies within a minute may as well be seconds, and has the same steps.
// Throws Error with both readings when the dates may be read in two ways.
std::optional<std::vector<std::string>> ClockSeconds(const ClockTimes& table, Notices& notices);

}  // namespace slamdb::detail
