// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/clock_times.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::int64_t kDay = 86400;

struct Clock {
  std::int64_t seconds = 0;   // since midnight
  std::string_view fraction;  // digits behind the point
  bool leading_zero = false;  // `093015`, as nobody writes seconds
  double value() const {
    return static_cast<double>(seconds) + ParseNumber<double>(Concat("0.", fraction)).value_or(0);
  }
};

// `190259.764`.
std::optional<Clock> ClockOf(std::string_view text) {
  const std::string_view whole = text.substr(0, text.find('.'));
  const auto number = whole.size() <= 6 ? ParseNumber<std::uint32_t>(whole) : std::nullopt;
  if (!number || *number / 10000 > 23 || *number / 100 % 100 > 59 || *number % 100 > 59) return std::nullopt;
  const std::string_view fraction = whole.size() < text.size() ? text.substr(whole.size() + 1) : std::string_view();
  if (fraction.find_first_not_of("0123456789") != fraction.npos) return std::nullopt;
  return Clock{*number / 10000 * 3600 + *number / 100 % 100 * 60 + *number % 100, fraction,
               whole.size() == 6 && whole.front() == '0'};
}

// Whether the times go on from one minute to the next as they do within it, where seconds would jump by 40 more.
bool JumpAtMinutes(const std::vector<Clock>& clocks) {
  constexpr double kMedians = 10;
  std::vector<double> steps;
  for (std::size_t i = 1; i < clocks.size(); ++i) steps.push_back(std::abs(clocks[i].value() - clocks[i - 1].value()));
  if (steps.size() < 2) return false;
  const double longest = kMedians * MedianOf(steps);
  for (std::size_t i = 1; i < clocks.size(); ++i)
    if (clocks[i].seconds / 60 == clocks[i - 1].seconds / 60 + 1 && steps[i - 1] < 20 && steps[i - 1] <= longest)
      return true;
  return false;
}

// ---- Dates

// Days since 1970 of a date whose digits are in the order of the letters of `ddmmyy`.
std::optional<std::int64_t> DayOf(std::string_view date, std::string_view order) {
  std::string digits(date);
  if (date.size() >= 8 && date.find_first_of("-/.") == 4) std::erase_if(digits, [](char c) { return c < '0'; });
  if (digits.size() + 1 == order.size()) digits.insert(0, 1, '0');  // a number has no leading zero
  if (digits.size() != order.size() || digits.find_first_not_of("0123456789") != digits.npos) return std::nullopt;
  const auto part = [&](char letter) {
    int number = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
      if (order[i] == letter) number = number * 10 + (digits[i] - '0');
    return number;
  };
  const int year = order.size() == 6 ? part('y') + (part('y') < 80 ? 2000 : 1900) : part('y');
  if (year < 1980 || year > 2099) return std::nullopt;
  return DaysTo(year, part('m'), part('d'));
}

std::string ShownDay(std::int64_t day) {
  const std::chrono::year_month_day date = std::chrono::sys_days{std::chrono::days{day}};
  const auto two = [](unsigned number) { return Concat(number < 10 ? "0" : "", number); };
  return Concat(static_cast<int>(date.year()), '-', two(static_cast<unsigned>(date.month())), '-',
                two(static_cast<unsigned>(date.day())));
}

constexpr std::array<std::string_view, 4> kOrders = {"yyyymmdd", "ddmmyyyy", "ddmmyy", "yymmdd"};

// How the dates are to be read. Of eight digits only one order gives a year of our times.
std::string_view OrderOf(const ClockTimes& table) {
  std::vector<std::string_view> fitting;
  for (const std::string_view order : kOrders)
    if ((table.date_order.empty() || table.date_order == order) &&
        std::ranges::all_of(table.dates, [&](const std::string& date) { return DayOf(date, order).has_value(); }))
      fitting.push_back(order);
  if (fitting.size() == 1) return fitting[0];
  const std::string place = Concat("line ", table.first_line), &first = table.dates[0];
  if (fitting.empty())
    throw Error(ErrorKind::kDamaged, "", place,
                Concat("expected a date beside the time of the day, as 2023-11-14, 20231114 or ddmmyy, in every row, "
                       "found '",
                       first.substr(0, 40), "'"));
  throw Error(ErrorKind::kNotPossible, "", place,
              Concat("the date ", first, " may be ", ShownDay(*DayOf(first, fitting[0])), " (", fitting[0], ") or ",
                     ShownDay(*DayOf(first, fitting[1])), " (", fitting[1], "); name its column date [", fitting[0],
                     "] or date [", fitting[1], "]"));
}

// The day of each row.
std::vector<std::int64_t> DaysOf(const ClockTimes& table, const std::vector<Clock>& clocks) {
  std::vector<std::int64_t> days;
  if (!table.dates.empty()) {
    const std::string_view order = OrderOf(table);
    for (const std::string& date : table.dates) days.push_back(*DayOf(date, order));
    return days;
  }
  for (std::size_t i = 0, day = 0; i < clocks.size(); ++i) {
    if (i > 0 && clocks[i].seconds + kDay / 2 < clocks[i - 1].seconds) ++day;  // over midnight
    days.push_back(static_cast<std::int64_t>(day));
  }
  return days;
}

}  // namespace

std::optional<std::vector<std::string>> ClockSeconds(const ClockTimes& table, Notices& notices) {
  std::vector<Clock> clocks;
  for (const std::string& time : table.times) {
    const auto clock = ClockOf(time);
    if (!clock) return std::nullopt;
    clocks.push_back(*clock);
  }
  if (clocks.empty()) return std::nullopt;
  const bool shown = table.stated || !table.dates.empty() || JumpAtMinutes(clocks) ||
                     std::ranges::any_of(clocks, [](const Clock& clock) { return clock.leading_zero; });
  if (!shown) return std::nullopt;
  const std::vector<std::int64_t> days = DaysOf(table, clocks);
  std::vector<std::string> seconds;
  for (std::size_t i = 0; i < clocks.size(); ++i)
    seconds.push_back(SecondsText(days[i] * kDay + clocks[i].seconds, clocks[i].fraction));
  notices.Note(Concat("times are taken as times of day, hhmmss: the first, ", table.times[0], ", as ",
                      table.dates.empty() ? Concat(seconds[0], " s since midnight, since no date stands beside it")
                                          : Concat(seconds[0], " s since 1970, on ", ShownDay(days[0]), ", in UTC")));
  return seconds;
}

}  // namespace slamdb::detail
