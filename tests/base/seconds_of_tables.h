// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/times.h"
#include "tests/support/error_of.h"

// The times of small tables, with a column of dates perhaps, read as all readers of tables do.
namespace slamdb::detail {

inline TimeRules Rules(std::optional<TimeUnit> asked = {}) { return {.asked = asked, .time = 0, .date = 1}; }

inline std::vector<std::string> Seconds(std::string_view text, Notices& notices, const TimeRules& rules = Rules()) {
  Table table(text, {.columns = {TimeColumn(), {{"date"}, Column::kOptional}}, .expected = "a time"});
  TimeReader times(table, rules);
  while (table.Next()) times.Add();
  return times.Seconds(notices);
}

inline std::vector<std::string> Seconds(std::string_view text, const TimeRules& rules = Rules()) {
  Notices notices;
  return Seconds(text, notices, rules);
}

inline std::string Failure(std::string_view text) {
  return ErrorOf([text] { Seconds(text); }).what();
}

}  // namespace slamdb::detail
