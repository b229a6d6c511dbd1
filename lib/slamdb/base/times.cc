// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/times.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"

namespace slamdb {
namespace {

constexpr std::array kUnits = {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                               TimeUnit::kNanoseconds};
constexpr std::array<std::string_view, 4> kShort = {"s", "ms", "us", "ns"};
constexpr std::array<std::string_view, 4> kLong = {"seconds", "milliseconds", "microseconds", "nanoseconds"};

}  // namespace

std::string_view NameOf(TimeUnit unit) { return kShort[static_cast<std::size_t>(unit)]; }

std::optional<TimeUnit> TimeUnitByName(std::string_view name) {
  static constexpr std::pair<std::string_view, TimeUnit> kSpellings[] = {{"sec", TimeUnit::kSeconds},
                                                                         {"secs", TimeUnit::kSeconds},
                                                                         {"second", TimeUnit::kSeconds},
                                                                         {"msec", TimeUnit::kMilliseconds},
                                                                         {"msecs", TimeUnit::kMilliseconds},
                                                                         {"millis", TimeUnit::kMilliseconds},
                                                                         {"usec", TimeUnit::kMicroseconds},
                                                                         {"usecs", TimeUnit::kMicroseconds},
                                                                         {"micros", TimeUnit::kMicroseconds},
                                                                         {"nsec", TimeUnit::kNanoseconds},
                                                                         {"nsecs", TimeUnit::kNanoseconds},
                                                                         {"nanos", TimeUnit::kNanoseconds},
                                                                         {"nanosec", TimeUnit::kNanoseconds},
                                                                         {"millisecond", TimeUnit::kMilliseconds},
                                                                         {"nanosecond", TimeUnit::kNanoseconds},
                                                                         {"microsecond", TimeUnit::kMicroseconds}};
  for (const TimeUnit unit : kUnits)
    if (name == NameOf(unit) || name == kLong[static_cast<std::size_t>(unit)]) return unit;
  for (const auto& [spelling, unit] : kSpellings)
    if (name == spelling) return unit;
  return std::nullopt;
}

namespace detail {
namespace {

constexpr double kEpochBegin = 946684800, kEpochEnd = 4102444800;  // 2000 and 2100, seconds since 1970

// Between poses or fixes of one recording: seconds.
constexpr double kShortestStep = 2e-3, kLongestStep = 20;
// What cannot be a step of any recording.
constexpr double kTooShortStep = 1e-5, kTooLongStep = 1e5;

double SecondsIn(TimeUnit unit) { return std::pow(10.0, PowerOf(unit)); }
std::string_view LongNameOf(TimeUnit unit) { return kLong[static_cast<std::size_t>(unit)]; }

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
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(*year)),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
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

struct DateTime {
  std::string seconds;
  bool has_zone = false;
};

std::string SecondsText(std::int64_t seconds, std::string_view fraction) {
  return fraction.empty() ? std::to_string(seconds) : Concat(seconds, '.', fraction);
}

// `2023-11-14T22:13:20.25Z`, or with a blank between; the day may stand in another cell.
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

bool IsTimeOfDay(std::string_view text) { return TakeTimeOfDay(text).has_value(); }

std::string Shown(double seconds) { return IsEpoch(seconds) ? Fixed(seconds, 3) : Digits(seconds, 10); }

}  // namespace

int PowerOf(TimeUnit unit) { return -3 * static_cast<int>(unit); }

bool IsEpoch(double seconds) { return seconds >= kEpochBegin && seconds < kEpochEnd; }

std::optional<std::string> ShiftedDecimal(std::string_view number, int power) {
  const auto value = ParseNumber<double>(number);
  constexpr std::size_t kLongest = 200;
  if (!value || !std::isfinite(*value) || number.size() > kLongest) return std::nullopt;
  const bool negative = number.starts_with('-');
  if (number.starts_with('+') || negative) number.remove_prefix(1);
  if (const std::size_t e = number.find_first_of("eE"); e != number.npos) {
    power += ParseNumber<int>(number.substr(e + 1)).value_or(0);
    number = number.substr(0, e);
  } else if (power == 0) {
    return Concat(negative ? "-" : "", number);
  }
  std::string digits(number);
  std::size_t point = std::min(digits.find('.'), digits.size());
  if (point < digits.size()) digits.erase(point, 1);
  const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(point) + power;
  if (place > 400 || place < -400) return *value == 0 ? std::optional<std::string>("0") : std::nullopt;
  if (place <= 0) digits.insert(0, static_cast<std::size_t>(1 - place), '0');
  point = static_cast<std::size_t>(std::max<std::ptrdiff_t>(place, 1));
  if (digits.size() < point) digits.append(point - digits.size(), '0');
  digits.insert(point, 1, '.');
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
  if (digits.empty() || digits.front() == '.') digits.insert(0, 1, '0');
  return Concat(negative ? "-" : "", digits);
}

Column TimeColumn(int group) {
  return {{".header.stamp",
           ".header.stamp.sec",
           ".header.stamp.secs",
           "header_stamp",
           "header_stamp_sec",
           "header_stamp_secs",
           ".stamp.sec",
           ".stamp.secs",
           "timestamp",
           "time",
           "t",
           "stamp",
           "time_stamp",
           "unix_time",
           "gps_time",
           "utc_time",
           "datetime",
           "date_time",
           "utc",
           "seconds",
           "secs",
           "sec",
           "milliseconds",
           "microseconds",
           "nanoseconds",
           "rosbagtimestamp"},
          group,
          "timestamp"};
}

Column NanosecondsColumn() {
  return {
      {".header.stamp.nanosec", ".header.stamp.nsecs", ".header.stamp.nsec", "header_stamp_nanosec",
       "header_stamp_nsecs", "header_stamp_nsec", ".stamp.nanosec", ".stamp.nsecs", ".stamp.nsec", "nanosec", "nsecs"},
      Column::kOptional};
}

TimeReader::TimeReader(const Table& table, TimeRules rules) : table_(table), rules_(std::move(rules)) {}

void TimeReader::Add() {
  if (cells_.empty()) first_line_ = table_.line();
  std::string cell = table_.Digits(rules_.time);
  const auto number = ParseNumber<double>(cell);
  if (number && std::isfinite(*number)) {
    if (rules_.nanoseconds && table_.Has(*rules_.nanoseconds)) {
      const auto behind = table_.Get<std::uint32_t>(*rules_.nanoseconds, "nanoseconds below 1000000000");
      const auto whole = table_.Get<std::int64_t>(rules_.time, "whole seconds, since nanoseconds stand beside them");
      if (behind >= 1'000'000'000) throw table_.CellError(*rules_.nanoseconds, "nanoseconds below 1000000000");
      std::string fraction = std::to_string(behind);
      cell = Concat(whole, '.', std::string(9 - fraction.size(), '0') + fraction);
    }
    if (!ShiftedDecimal(cell, 0)) throw table_.CellError(rules_.time, "a time");
    has_point_ |= cell.find('.') != cell.npos;
  } else {
    const std::string_view date =
        rules_.date && table_.Has(*rules_.date) ? Trimmed(table_.Raw(*rules_.date)) : std::string_view();
    if (IsTimeOfDay(cell) && date.empty())
      throw table_.CellError(rules_.time, "seconds, or a time with its date (the time of a day alone tells no day)");
    const auto time = ParseDateTime(Trimmed(table_.Raw(rules_.time)), date);
    if (!time) throw table_.CellError(rules_.time, "a number, or date and time as 2023-11-14T22:13:20Z");
    ++dates_;
    without_zone_ |= !time->has_zone;
    cell = time->seconds;
  }
  values_.push_back(ParseNumber<double>(cell).value_or(0));
  cells_.push_back(std::move(cell));
  if (dates_ > 0 && dates_ != cells_.size())
    throw table_.CellError(rules_.time, dates_ < cells_.size() && number ? "date and time, as in the rows above"
                                                                         : "a number, as in the rows above");
}

std::vector<std::string> TimeReader::Seconds(Notices& notices) const {
  if (cells_.empty()) return {};
  if (dates_ > 0 && without_zone_) notices.Note("dates and times state no time zone and are taken as UTC");
  const TimeUnit unit = dates_ > 0 ? TimeUnit::kSeconds : Unit(notices);
  std::vector<std::string> seconds;
  seconds.reserve(cells_.size());
  for (const std::string& cell : cells_) seconds.push_back(ShiftedDecimal(cell, PowerOf(unit)).value_or(cell));
  return seconds;
}

TimeUnit TimeReader::Unit(Notices& notices) const {
  const ColumnName* name = table_.NameOf(rules_.time);
  if (name != nullptr && Comparable(name->text).find("stamp") != std::string::npos) {
    const auto receipt = std::ranges::find(table_.names(), "time", &ColumnName::text);
    if (receipt != table_.names().end() && &*receipt != name)
      notices.Note("times are those of the column " + name->text +
                   ", not of the column time, which tells when they "
                   "were received");
  }
  if (rules_.nanoseconds && table_.Has(*rules_.nanoseconds)) return TimeUnit::kSeconds;
  if (rules_.asked) return *rules_.asked;
  if (name == nullptr || name->unit.empty()) return UnitByValues(notices);
  const auto stated = TimeUnitByName(name->unit);
  if (!stated)
    throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
                Concat("expected times in s, ms, us or ns, found the unit '", name->unit, "'"));
  RequirePlausible(*stated);
  return *stated;
}

double TimeReader::MedianStep() const {
  if (values_.size() < 3) return 0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < values_.size(); ++i) steps.push_back(std::abs(values_[i] - values_[i - 1]));
  return MedianOf(std::move(steps));
}

// Whether all times lie in this century when they count that unit, and the steps between them are within bounds.
bool TimeReader::Fits(TimeUnit unit, double least_step, double most_step) const {
  const auto [least, most] = std::ranges::minmax(values_);
  const double scale = SecondsIn(unit), step = MedianStep() * scale;
  return IsEpoch(least * scale) && IsEpoch(most * scale) && (step == 0 || (step >= least_step && step <= most_step));
}

std::string TimeReader::Reading(TimeUnit unit) const {
  const double scale = SecondsIn(unit);
  return Concat("as ", LongNameOf(unit), " the first is ", Shown(values_.front() * scale), " s and steps are ",
                Digits(MedianStep() * scale, 3), " s");
}

Error TimeReader::Ambiguous(TimeUnit one, TimeUnit other, const std::string& why) const {
  return Error(ErrorKind::kNotPossible, "", Concat("line ", first_line_),
               Concat("the times may be ", LongNameOf(one), " or ", LongNameOf(other), why, ": ", Reading(one), ", ",
                      Reading(other), "; the time unit of the read options settles it"));
}

// A table of seconds under a heading of nanoseconds, or the other way round.
void TimeReader::RequirePlausible(TimeUnit stated) const {
  const double step = MedianStep() * SecondsIn(stated);
  if (step == 0 || (step > kTooShortStep && step < kTooLongStep)) return;
  for (const TimeUnit unit : kUnits)
    if (unit != stated && Fits(unit, kTooShortStep, kTooLongStep))
      throw Ambiguous(stated, unit, Concat(" (the name of their column says ", NameOf(stated), ")"));
}

TimeUnit TimeReader::UnitByValues(Notices& notices) const {
  const auto chosen = [&](TimeUnit unit) {
    if (unit != rules_.usual)
      notices.Note(
          Concat("times are taken as ", LongNameOf(unit), ": ", Reading(unit), ", but ", Reading(rules_.usual)));
    return unit;
  };
  for (const TimeUnit unit : kUnits)
    if (Fits(unit, kTooShortStep, kTooLongStep)) return chosen(unit);
  const double step = MedianStep();
  std::vector<TimeUnit> plausible;
  for (const TimeUnit unit : kUnits)
    if (step * SecondsIn(unit) >= kShortestStep && step * SecondsIn(unit) <= kLongestStep) plausible.push_back(unit);
  const bool usual = std::ranges::find(plausible, rules_.usual) != plausible.end();
  if (plausible.empty() || (usual && (plausible.size() == 1 || rules_.firm))) return rules_.usual;
  // Whoever writes decimals writes seconds.
  if (has_point_ && rules_.usual == TimeUnit::kSeconds && step < kTooLongStep) return rules_.usual;
  if (plausible.size() > 1) throw Ambiguous(plausible[0], plausible[1], "");
  return chosen(plausible[0]);
}

}  // namespace detail
}  // namespace slamdb
