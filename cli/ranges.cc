// SPDX-License-Identifier: BSD-3-Clause
#include "cli/ranges.h"

#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using detail::ParseNumber;

std::optional<TimeRange> At(Moment::From from, double seconds) {
  if (std::isnan(seconds)) return std::nullopt;
  return TimeRange{{from, seconds}, {from, seconds}};
}

std::optional<double> SecondsOfDate(const std::string& text) {
  const auto date = detail::ParseDateTime(text, {});
  return date ? ParseNumber<double>(date->seconds) : std::nullopt;
}

// A day is as long as it is; all others begin when they end.
std::optional<TimeRange> ParseMoment(const std::string& text) {
  constexpr double kDay = 86400, kJustBefore = 1e-6;
  using From = Moment::From;
  if (const auto seconds = ParseNumber<double>(text))
    return At(text.starts_with('+') ? From::kFirst : text.starts_with('-') ? From::kLast : From::kClock, *seconds);
  if (const auto seconds = SecondsOfDate(text)) {  // a whole second, as a day is a whole day
    const bool has_fraction = text.find_first_of(".,", text.find(':')) != std::string::npos;
    return TimeRange{{From::kClock, *seconds}, {From::kClock, has_fraction ? *seconds : *seconds + 1 - kJustBefore}};
  }
  const auto midnight = SecondsOfDate(text + "T00:00:00Z");
  if (!midnight) return std::nullopt;
  return TimeRange{{From::kClock, *midnight}, {From::kClock, *midnight + kDay - kJustBefore}};
}

std::optional<TimeRange> ParseEnd(std::string_view text) {
  constexpr double kForEver = std::numeric_limits<double>::infinity();
  if (!text.empty()) return ParseMoment(std::string(text));
  return TimeRange{{Moment::From::kClock, -kForEver}, {Moment::From::kClock, kForEver}};
}

// What `take` makes of what stands before and behind `..` or a colon: of the first where it makes something, as times
// of day have colons too.
template <class Take>
auto TakeEnds(std::string_view text, const Take& take) -> decltype(take(text, text)) {
  for (const std::string_view separator : {"..", ":"})
    for (std::size_t at = text.find(separator); at != std::string_view::npos; at = text.find(separator, at + 1)) {
      const std::string_view first = text.substr(0, at), last = text.substr(at + separator.size());
      if (first.empty() && last.empty()) continue;
      if (auto range = take(first, last)) return range;
    }
  return std::nullopt;
}

constexpr const char* kForms = "seconds, or dates (2026-01-31, 2026-01-31T12:00:00Z)";
constexpr const char* kOneEnd = "; an end may be left out";
constexpr const char* kCounted = "+10 for 10 s after the first keyframe, -10 for 10 s before the last";

std::string CheckTimeRange(const std::string& text) {
  if (ParseTimeRange(text)) return {};
  return Concat("expected a time, or two as BEGIN:END, in ", kForms, ", found '", text, "'");
}

std::string CheckClockRange(const std::string& text) {
  if (std::string problem = CheckTimeRange(text); !problem.empty()) return problem;
  if (!ParseTimeRange(text)->is_relative()) return {};
  return Concat("'", text, "' counts from keyframes, which are others in each map; expected ", kForms);
}

std::string CheckIdRange(const std::string& text) {
  return ParseIdRange(text) ? std::string() : "expected a keyframe id, or two as FIRST:LAST, found '" + text + "'";
}

}  // namespace

double Moment::In(const TimeSpan& keyframes) const {
  switch (from) {
    case From::kFirst:
      return keyframes.begin + seconds;
    case From::kLast:
      return keyframes.end + seconds;
    default:
      return seconds;
  }
}

std::optional<TimeRange> ParseTimeRange(std::string_view text) {
  if (const auto moment = ParseMoment(std::string(text))) return moment;
  return TakeEnds(text, [](std::string_view first, std::string_view last) -> std::optional<TimeRange> {
    const auto from = ParseEnd(first), to = ParseEnd(last);
    if (!from || !to) return std::nullopt;
    const TimeRange range{from->begin, to->end};
    const bool backwards = range.begin.from == range.end.from && range.begin.seconds > range.end.seconds;
    return backwards ? std::nullopt : std::optional(range);
  });
}

std::optional<MapQuery::Ids> ParseIdRange(std::string_view text) {
  if (const auto one = ParseNumber<std::uint64_t>(text)) return MapQuery::Ids{*one, *one};
  return TakeEnds(text, [](std::string_view first, std::string_view last) -> std::optional<MapQuery::Ids> {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
    const auto from = first.empty() ? std::optional<std::uint64_t>(0) : ParseNumber<std::uint64_t>(first);
    const auto to = last.empty() ? std::optional(kMost) : ParseNumber<std::uint64_t>(last);
    if (!from || !to || *from > *to) return std::nullopt;
    return MapQuery::Ids{*from, *to};
  });
}

std::optional<NumberRange> ParseNumberRange(std::string_view text,
                                            const std::function<std::optional<double>(std::string_view)>& parse) {
  const auto end_of = [&](std::string_view end, double other) -> std::optional<double> {
    const auto number = end.empty() ? std::optional(other) : parse(end);
    return number && std::isnan(*number) ? std::nullopt : number;
  };
  if (text.empty()) return std::nullopt;
  if (const auto one = end_of(text, 0)) return NumberRange{*one, *one};
  return TakeEnds(text, [&](std::string_view first, std::string_view last) -> std::optional<NumberRange> {
    const auto low = end_of(first, NumberRange{}.low), high = end_of(last, NumberRange{}.high);
    if (!low || !high || *low > *high) return std::nullopt;
    return NumberRange{*low, *high};
  });
}

CLI::Option* AddTimeRange(CLI::App& verb, std::string& range, const std::string& help) {
  return verb.add_option("--time", range, Concat(help, ", both ends included: ", kForms, ", or ", kCounted, kOneEnd))
      ->type_name("BEGIN:END")
      ->check(CheckTimeRange);
}

CLI::Option* AddClockRange(CLI::App& verb, std::string& range, const std::string& help) {
  return verb.add_option("--time", range, Concat(help, ": ", kForms, kOneEnd))
      ->type_name("BEGIN:END")
      ->check(CheckClockRange);
}

CLI::Option* AddIdRange(CLI::App& verb, std::string& range, const std::string& help) {
  return verb.add_option("--keyframes", range, Concat(help, ", both ends included", kOneEnd))
      ->type_name("FIRST:LAST")
      ->check(CheckIdRange);
}

}  // namespace slamdb::cli
