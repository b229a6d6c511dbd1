// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/times.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slamdb/base/detail/clock_times.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/median.h"

namespace slamdb::detail {
namespace {

// Between poses or fixes of one recording: seconds.
constexpr double kShortestStep = 2e-3, kLongestStep = 20;
// What cannot be a step of any recording.
constexpr double kTooShortStep = 1e-5, kTooLongStep = 1e5;

double SecondsIn(TimeUnit unit) { return std::pow(10.0, PowerOf(unit)); }

// A column's name without the unit that it ends with, and that: `stamp` and ns of `stamp_nanosec` or `/stamp/nanosec`,
// nothing and ns of `nsec`.
struct NameApart {
  std::string stem;
  std::optional<TimeUnit> unit;
};

NameApart Apart(const ColumnName& name) {
  if (name.name != name.text) return {Comparable(name.name), TimeUnitByName(name.unit)};
  const std::string text = Comparable(name.text);
  const std::size_t mark = text.find_last_of("._");
  const auto unit = TimeUnitByName(std::string_view(text).substr(mark == text.npos ? 0 : mark + 1));
  return unit ? NameApart{text.substr(0, mark == text.npos ? 0 : mark), unit} : NameApart{text, unit};
}

bool IsTimeName(std::string_view stem) {
  const Column column = TimeColumn();
  return std::ranges::find(column.names, stem) != column.names.end();
}

// The unit of a column when its name makes it times that belong to another column's, in a finer unit.
// `ns` alone is north or south.
std::optional<TimeUnit> FinerUnit(const ColumnName& name, const ColumnName& time) {
  const NameApart finer = Apart(name), coarse = Apart(time);
  if (!finer.unit || *finer.unit <= coarse.unit.value_or(TimeUnit::kSeconds)) return std::nullopt;
  const bool related = finer.stem == coarse.stem || (finer.stem.empty() && name.text != "ns") ||
                       (coarse.stem.empty() && (finer.stem.empty() || IsTimeName(finer.stem)));
  return related ? finer.unit : std::nullopt;
}

// The digits of a whole number, `5` of `5.0`; nothing of others.
std::optional<std::string> WholeNumber(std::string_view number) {
  const auto digits = ShiftedDecimal(number, 0);
  const std::size_t point = digits ? std::min(digits->find('.'), digits->size()) : 0;
  if (!digits || digits->find_first_not_of("0.", point) != digits->npos) return std::nullopt;
  return digits->substr(0, point);
}

std::string Shown(double seconds) { return IsEpoch(seconds) ? Fixed(seconds, 3) : Digits(seconds, 10); }

}  // namespace

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
           "__time",
           "time",
           "t",
           "stamp",
           "time_stamp",
           "unix_time",
           "unixtime",
           "utctime",
           "gpstime",
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
          "timestamp",
          true};
}

TimeReader::TimeReader(const Table& table, TimeRules rules) : table_(table), rules_(std::move(rules)) {
  const ColumnName* time = table.NameOf(rules_.time);
  if (time == nullptr) return;
  for (std::size_t i = 0; i < table.names().size(); ++i)
    if (const ColumnName& name = table.names()[i]; &name != time)
      if (const auto unit = FinerUnit(name, *time)) finer_.push_back({i, name.text, *unit});
}

void TimeReader::Add() {
  std::string cell = table_.Digits(rules_.time);
  const auto number = ParseNumber<double>(cell);
  if (number && std::isfinite(*number)) {
    if (!ShiftedDecimal(cell, 0)) throw table_.CellError(rules_.time, "a time");
    has_point_ |= cell.find('.') != cell.npos;
    if (rules_.date && table_.Has(*rules_.date)) days_.emplace_back(Trimmed(table_.Raw(*rules_.date)));
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
  lines_.push_back(table_.line());
  for (FinerTimes& finer : finer_) finer.cells.push_back(table_.DigitsAt(finer.place));
  if (dates_ > 0 && dates_ != cells_.size())
    throw table_.CellError(rules_.time, dates_ < cells_.size() && number ? "date and time, as in the rows above"
                                                                         : "a number, as in the rows above");
}

std::vector<std::string> TimeReader::Seconds(Notices& notices) const {
  if (cells_.empty()) return {};
  if (dates_ > 0 && without_zone_) notices.Note("dates and times state no time zone and are taken as UTC");
  TellWhichColumn(notices);
  for (const FinerTimes& finer : finer_)
    if (auto seconds = WithFraction(finer)) return WithRepeatsTold(*std::move(seconds), notices);
  if (auto seconds = ClockTimes(notices)) return *std::move(seconds);
  const TimeUnit unit = dates_ > 0 ? TimeUnit::kSeconds : Unit(notices);
  for (const FinerTimes& finer : finer_) {
    if (dates_ > 0 || finer.unit <= unit || (rules_.asked && !NameSaysSeconds())) continue;
    auto seconds = InFinerUnit(finer, unit);
    if (!seconds) throw NotOneTime(finer);
    notices.Note(Concat("times are those of the column ", finer.name, ", which has more digits than ",
                        table_.NameOf(rules_.time)->text));
    return WithRepeatsTold(*std::move(seconds), notices);
  }
  std::vector<std::string> seconds;
  seconds.reserve(cells_.size());
  for (const std::string& cell : cells_) seconds.push_back(ShiftedDecimal(cell, PowerOf(unit)).value_or(cell));
  return WithRepeatsTold(std::move(seconds), notices);
}

bool TimeReader::NameSaysSeconds() const { return Apart(*table_.NameOf(rules_.time)).unit == TimeUnit::kSeconds; }

// The times when they are whole seconds and those of the other column are below one. Nothing: they are something else.
std::optional<std::vector<std::string>> TimeReader::WithFraction(const FinerTimes& finer) const {
  if (rules_.asked && rules_.asked != TimeUnit::kSeconds && !NameSaysSeconds()) return std::nullopt;
  const auto named = Apart(*table_.NameOf(rules_.time)).unit;
  if (named && named != TimeUnit::kSeconds) return std::nullopt;
  std::vector<std::string> seconds;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto behind = ShiftedDecimal(finer.cells[i], PowerOf(finer.unit));
    const auto whole = WholeNumber(cells_[i]);
    if (!behind || !whole || values_[i] < 0 || values_[i] >= kEpochEnd || ParseNumber<double>(*behind) >= 1 ||
        behind->starts_with('-'))
      return std::nullopt;
    seconds.push_back(*whole + behind->substr(std::min(behind->find('.'), behind->size())));
  }
  return seconds;
}

// Numbers that are times of day. Those beside a date that are neither these nor of this century say too little.
std::optional<std::vector<std::string>> TimeReader::ClockTimes(Notices& notices) const {
  const ColumnName* name = table_.NameOf(rules_.time);
  const bool stated = name != nullptr && name->unit == "hhmmss";
  if (dates_ > 0 || rules_.asked || (name != nullptr && !name->unit.empty() && !stated)) return std::nullopt;
  const ColumnName* date = rules_.date ? table_.NameOf(*rules_.date) : nullptr;
  auto seconds = ClockSeconds({.times = cells_,
                               .dates = days_,
                               .date_order = date != nullptr ? std::string_view(date->unit) : std::string_view(),
                               .stated = stated,
                               .first_line = lines_.front()},
                              notices);
  if (!seconds && !days_.empty() && std::ranges::max(values_) < kEpochBegin)
    throw Error(ErrorKind::kNotPossible, "", Concat("line ", lines_.front()),
                Concat("expected the time of the day as hhmmss or 22:13:20 beside its date, found ", cells_[0],
                       "; times that do not count from the date need their unit: the time unit of the read options "
                       "settles it"));
  return seconds;
}

// The times of the other column when they tell the same as these, which have fewer digits.
std::optional<std::vector<std::string>> TimeReader::InFinerUnit(const FinerTimes& finer, TimeUnit unit) const {
  std::vector<std::string> seconds;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    auto time = ShiftedDecimal(finer.cells[i], PowerOf(finer.unit));
    if (!time || std::abs(ParseNumber<double>(*time).value_or(0) - values_[i] * SecondsIn(unit)) >= SecondsIn(unit))
      return std::nullopt;
    seconds.push_back(*std::move(time));
  }
  return seconds;
}

Error TimeReader::NotOneTime(const FinerTimes& finer) const {
  std::size_t row = 0;
  const auto is_pair = [&](std::size_t i) {
    const auto behind = ShiftedDecimal(finer.cells[i], PowerOf(finer.unit));
    return WholeNumber(cells_[i]) && behind && !behind->starts_with('-') && ParseNumber<double>(*behind) < 1;
  };
  while (row + 1 < cells_.size() && is_pair(row)) ++row;
  return Error(ErrorKind::kDamaged, "", Concat("line ", lines_[row]),
               Concat("the columns ", table_.NameOf(rules_.time)->text, " and ", finer.name,
                      " are neither whole seconds and the ", LongNameOf(finer.unit),
                      " behind them (below one second) nor the same time twice: found ", cells_[row], " and ",
                      finer.cells[row]));
}

// Whoever drops the fraction of a second gets many poses at one time.
std::vector<std::string> TimeReader::WithRepeatsTold(std::vector<std::string> seconds, Notices& notices) const {
  std::size_t equal = 0;
  for (std::size_t i = 1; i < seconds.size(); ++i) equal += seconds[i] == seconds[i - 1];
  if (equal > 1 && equal * 2 >= seconds.size())
    notices.Warn(Concat("most rows have the time of the row before: ", equal, " of ", seconds.size(),
                        "; is the fraction of a second in another column, or lost?"));
  return seconds;
}

void TimeReader::TellWhichColumn(Notices& notices) const {
  const ColumnName* name = table_.NameOf(rules_.time);
  if (name != nullptr && Comparable(name->text).find("stamp") != std::string::npos) {
    const auto receipt = std::ranges::find(table_.names(), "time", &ColumnName::text);
    if (receipt != table_.names().end() && &*receipt != name)
      notices.Note("times are those of the column " + name->text +
                   ", not of the column time, which tells when they "
                   "were received");
  }
}

TimeUnit TimeReader::Unit(Notices& notices) const {
  const ColumnName* name = table_.NameOf(rules_.time);
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
  return Error(ErrorKind::kNotPossible, "", Concat("line ", lines_.front()),
               Concat("the times may be ", LongNameOf(one), " or ", LongNameOf(other), why, ": ", Reading(one), ", ",
                      Reading(other), "; the time unit of the read options settles it"));
}

// A table of seconds under a heading of nanoseconds, or the other way round.
void TimeReader::RequirePlausible(TimeUnit stated) const {
  const double step = MedianStep() * SecondsIn(stated);
  const bool future = std::ranges::max(values_) * SecondsIn(stated) >= kEpochEnd;
  if (!future && (step == 0 || (step > kTooShortStep && step < kTooLongStep))) return;
  for (const TimeUnit unit : kTimeUnits)
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
  for (const TimeUnit unit : kTimeUnits)
    if (Fits(unit, kTooShortStep, kTooLongStep)) return chosen(unit);
  const double step = MedianStep();
  std::vector<TimeUnit> plausible;
  for (const TimeUnit unit : kTimeUnits)
    if (step * SecondsIn(unit) >= kShortestStep && step * SecondsIn(unit) <= kLongestStep) plausible.push_back(unit);
  const bool usual = std::ranges::find(plausible, rules_.usual) != plausible.end();
  if (plausible.empty() || (usual && (plausible.size() == 1 || rules_.firm))) return rules_.usual;
  // Whoever writes decimals writes seconds, where these are plausible.
  if (has_point_ && usual && rules_.usual == TimeUnit::kSeconds) {
    notices.Note(Concat("times are taken as seconds, as they have decimals: ", Reading(rules_.usual), ", but ",
                        Reading(plausible[1])));
    return rules_.usual;
  }
  if (plausible.size() > 1) throw Ambiguous(plausible[0], plausible[1], "");
  return chosen(plausible[0]);
}

}  // namespace slamdb::detail
