// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "cli/help/tree.h"
#include "slamdb/many/selected.h"
#include "slamdb/model/map_query.h"

// Ranges of times and of ids as they are typed: one grammar for every verb.
namespace slamdb::cli {

// Seconds of the clock, or behind the first keyframe (`+10`), or from the last one (`-10`).
struct Moment {
  enum class From { kClock, kFirst, kLast } from = From::kClock;
  double seconds = 0;

  double In(const TimeSpan& keyframes) const;
};

// Both ends included; one that is left out is infinite.
struct TimeRange {
  Moment begin, end;

  bool is_relative() const { return begin.from != Moment::From::kClock || end.from != Moment::From::kClock; }
  TimeSpan In(const TimeSpan& keyframes) const { return {begin.In(keyframes), end.In(keyframes)}; }
};

// `BEGIN:END` or `BEGIN..END`, of which one end may be left out, or one moment: seconds, a date with a time of day
// (`2026-01-31T12:00:00Z`), or a day (`2026-01-31`), which is all of its seconds. Nothing for what is none.
std::optional<TimeRange> ParseTimeRange(std::string_view text);

// `FIRST:LAST` or `FIRST..LAST`, of which one end may be left out, or one id. Nothing for what is none.
std::optional<MapQuery::Ids> ParseIdRange(std::string_view text);

// The same of numbers, each of which `parse` takes; an end that is left out is infinite.
struct NumberRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};
std::optional<NumberRange> ParseNumberRange(std::string_view text,
                                            const std::function<std::optional<double>(std::string_view)>& parse);

// --time and --keyframes, which refuse what is no range; their help is `help` with the forms.
CLI::Option* AddTimeRange(CLI::App& verb, std::string& range, const std::string& help);
// --time where nothing tells from which keyframes to count: of the clock alone.
CLI::Option* AddClockRange(CLI::App& verb, std::string& range, const std::string& help);
CLI::Option* AddIdRange(CLI::App& verb, std::string& range, const std::string& help);

}  // namespace slamdb::cli
