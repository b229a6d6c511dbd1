// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/table.h"
#include "slamdb/base/detail/time_units.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/time_unit.h"
#include "slamdb/export.h"

// The times of tables, whatever they count. schema/tables.md says how the unit is told.
namespace slamdb::detail {

// The column of times as all tables have it.
Column TimeColumn(int group = 0);

// What a table tells of its times.
struct TimeRules {
  std::optional<TimeUnit> asked;        // by the user
  TimeUnit usual = TimeUnit::kSeconds;  // of such tables
  bool firm = false;                    // the usual one is taken where others are as plausible
  std::size_t time = 0;                 // the column
  std::optional<std::size_t> date{};    // the column of the day, where the time is that of a day
};

// A column beside that of the times whose name makes it the same times in a finer unit, or what is behind whole
// seconds: `nsec` beside `sec`, `stamp_nanosec` beside `stamp_sec`.
struct FinerTimes {
  std::size_t place = 0;  // in a row
  std::string name;
  TimeUnit unit = TimeUnit::kNanoseconds;
  std::vector<std::string> cells{};
};

// Collects the times of a table row by row, and makes seconds of them at the end, when all of them tell the unit.
class TimeReader {
 public:
  TimeReader(const Table& table, TimeRules rules);

  // Throws Error with line and column when the row's time is none: neither a finite number nor date and time.
  void Add();

  // Seconds since 1970, or whatever the table counts from, with all digits of the table. Tells in the notices what was
  // not said by the table itself.
  // Throws Error when the unit is unknown, or several are as plausible as each other.
  std::vector<std::string> Seconds(Notices& notices) const;

 private:
  std::optional<std::vector<std::string>> WithFraction(const FinerTimes& finer) const;
  std::optional<std::vector<std::string>> InFinerUnit(const FinerTimes& finer, TimeUnit unit) const;
  Error NotOneTime(const FinerTimes& finer) const;
  bool NameSaysSeconds() const;
  std::vector<std::string> WithRepeatsTold(std::vector<std::string> seconds, Notices& notices) const;
  void TellWhichColumn(Notices& notices) const;
  std::optional<std::vector<std::string>> ClockTimes(Notices& notices) const;
  TimeUnit Unit(Notices& notices) const;
  TimeUnit UnitByValues(Notices& notices) const;
  void RequirePlausible(TimeUnit stated) const;
  bool Fits(TimeUnit unit, double least_step, double most_step) const;
  double MedianStep() const;
  std::string Reading(TimeUnit unit) const;
  Error Ambiguous(TimeUnit one, TimeUnit other, const std::string& why) const;

  const Table& table_;
  const TimeRules rules_;
  std::vector<std::string> cells_;  // numbers, or seconds where the table has dates
  std::vector<double> values_;
  std::vector<FinerTimes> finer_;
  std::vector<std::size_t> lines_;
  std::vector<std::string> days_;  // beside numbers, where a column has them
  std::size_t dates_ = 0;
  bool without_zone_ = false, has_point_ = false;
};

}  // namespace slamdb::detail
