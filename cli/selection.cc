// SPDX-License-Identifier: BSD-3-Clause
#include "cli/selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/report/layout.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using detail::ParseNumber;

// A number, or a time that counts from the first keyframe (`+10`) or to the last one (`-10`).
struct Moment {
  enum class From { kZero, kFirst, kLast } from = From::kZero;
  double seconds = 0;

  double In(const TimeSpan& span) const {
    return seconds + (from == From::kFirst ? span.begin : from == From::kLast ? span.end : 0);
  }
};

std::optional<Moment> ParseMoment(std::string_view text) {
  const auto number = ParseNumber<double>(text);
  if (!number) return std::nullopt;
  return Moment{text.starts_with('+')   ? Moment::From::kFirst
                : text.starts_with('-') ? Moment::From::kLast
                                        : Moment::From::kZero,
                *number};
}

// What stands before and behind the colon of `A:B`, `A:` or `:B`; nothing where an end is left out.
template <class Value>
struct Ends {
  std::optional<Value> first, last;
};
template <class Parse>
auto ParseEnds(std::string_view text, const Parse& parse)
    -> std::optional<Ends<typename decltype(parse(text))::value_type>> {
  const auto sides = detail::Split(text, ':');
  if (sides.size() != 2 || text.size() == 1) return std::nullopt;
  Ends<typename decltype(parse(text))::value_type> ends{parse(sides[0]), parse(sides[1])};
  if ((!sides[0].empty() && !ends.first) || (!sides[1].empty() && !ends.last)) return std::nullopt;
  return ends;
}

std::optional<Ends<Moment>> ParseTimes(std::string_view text) {
  const auto times = ParseEnds(text, ParseMoment);
  const bool comparable = times && times->first && times->last && times->first->from == times->last->from;
  return comparable && times->first->seconds > times->last->seconds ? std::nullopt : times;
}

std::optional<Ends<std::uint64_t>> ParseIds(std::string_view text) {
  const auto ids = ParseEnds(text, ParseNumber<std::uint64_t>);
  return ids && ids->first && ids->last && *ids->first > *ids->last ? std::nullopt : ids;
}

std::optional<Eigen::Vector3f> ParseVector(std::string_view text) {
  const auto numbers = detail::Split(text, ',');
  if (numbers.size() != 3) return std::nullopt;
  Eigen::Vector3f vector;
  for (int i = 0; i < 3; ++i) {
    const auto number = ParseNumber<float>(numbers[i]);
    if (!number) return std::nullopt;
    vector[i] = *number;
  }
  return vector;
}

// `x,y,z:x,y,z`, the corners of a box in either order.
std::optional<Eigen::AlignedBox3f> ParseBox(std::string_view text) {
  const auto corners = detail::Split(text, ':');
  const auto a = ParseVector(corners.front()), b = ParseVector(corners.back());
  if (corners.size() != 2 || !a || !b) return std::nullopt;
  Eigen::AlignedBox3f box(*a);
  return box.extend(*b);
}

std::string CheckKeyframes(const std::string& text) {
  return ParseIds(text) ? std::string() : "expected keyframe ids as FIRST:LAST, found '" + text + "'";
}

std::string CheckTime(const std::string& text) {
  return ParseTimes(text) ? std::string() : "expected seconds as BEGIN:END, found '" + text + "'";
}

std::string CheckBox(const std::string& text) {
  return ParseBox(text) ? std::string() : "expected two corners as X,Y,Z:X,Y,Z, found '" + text + "'";
}

bool IsRelative(const std::optional<Moment>& moment) { return moment && moment->from != Moment::From::kZero; }

void SelectTimes(const Ends<Moment>& times, const std::optional<TimeSpan>& span, Selection& selection) {
  if ((IsRelative(times.first) || IsRelative(times.last)) && !span)
    throw Error(ErrorKind::kNotPossible, "--time counts from keyframes, of which none has a time");
  const TimeSpan known = span.value_or(TimeSpan());
  if (times.first) selection.begin_time = times.first->In(known);
  if (times.last) selection.end_time = times.last->In(known);
}

std::string SecondsText(double seconds) {
  constexpr double kNoTime = 1e15;  // which would only be long
  if (std::abs(seconds) >= kNoTime) return detail::Digits(seconds);
  std::string text;
  detail::AppendSeconds(text, seconds);
  return text;
}

// The input once more, for its times alone.
std::optional<TimeSpan> ReadSpan(const HeldSource& input, ReadOptions read, const std::optional<MapId>& map) {
  read.selection = {};
  read.features = FeatureColumns::kNone;
  return SpanOf(ReadAtlas(input, read), map ? std::optional(map->value()) : std::nullopt);
}

}  // namespace

void AddSelection(CLI::App& verb, SelectionOptions& options) {
  constexpr const char* kGroup = "Selection";
  verb.add_option("--map", options.map, "Only the map of this id")->type_name("ID")->group(kGroup);
  verb.add_option("--keyframes", options.keyframes,
                  "Only keyframes of these ids, both included; an end may be left out")
      ->type_name("FIRST:LAST")
      ->check(CheckKeyframes)
      ->group(kGroup);
  verb.add_option("--time", options.time,
                  "Only keyframes of this time span in seconds; both ends are included, and may be left out; +10 is "
                  "10 s after the first keyframe, -10 as long before the last")
      ->type_name("BEGIN:END")
      ->check(CheckTime)
      ->group(kGroup);
  verb.add_option("--box", options.box, "Only points inside the box with these corners, in map coordinates")
      ->type_name("X,Y,Z:X,Y,Z")
      ->check(CheckBox)
      ->group(kGroup);
}

std::optional<TimeSpan> SpanOf(const Atlas& atlas, std::optional<std::uint64_t> id) {
  TimeSpan span{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Map& map : atlas.maps) {
    if (id && map.id != MapId(*id)) continue;
    for (const KeyFrame& keyframe : map.keyframes) {
      if (!std::isfinite(keyframe.timestamp)) continue;
      span = {std::min(span.begin, keyframe.timestamp), std::max(span.end, keyframe.timestamp)};
    }
  }
  return span.begin <= span.end ? std::optional(span) : std::nullopt;
}

bool NeedsSpan(const SelectionOptions& options) {
  const auto times = options.time.empty() ? std::nullopt : ParseTimes(options.time);
  return times && (IsRelative(times->first) || IsRelative(times->last));
}

Selection ParseSelection(const SelectionOptions& options, const std::optional<TimeSpan>& span) {
  Selection selection;
  if (options.map) selection.map = MapId(*options.map);
  if (!options.keyframes.empty()) {
    const auto ids = ParseIds(options.keyframes).value();
    selection.first_keyframe = ids.first.value_or(selection.first_keyframe);
    selection.last_keyframe = ids.last.value_or(selection.last_keyframe);
  }
  if (!options.time.empty()) SelectTimes(ParseTimes(options.time).value(), span, selection);
  if (!options.box.empty()) selection.box = ParseBox(options.box);
  return selection;
}

Selection ParseSelection(const SelectionOptions& options, const HeldSource& input, const ReadOptions& read) {
  if (!NeedsSpan(options)) return ParseSelection(options);
  const std::optional<MapId> map = options.map ? std::optional(MapId(*options.map)) : std::nullopt;
  return ParseSelection(options, ReadSpan(input, read, map));
}

std::string NoKeyframeIn(const Selection& selection, const std::optional<TimeSpan>& span) {
  std::string text = "has no keyframe";
  if (std::isfinite(selection.begin_time)) text += " from " + SecondsText(selection.begin_time) + " s";
  if (std::isfinite(selection.end_time)) text += " to " + SecondsText(selection.end_time) + " s";
  if (!span) return text + "; none has a time";
  return detail::Concat(text, "; its keyframes are from ", SecondsText(span->begin), " to ", SecondsText(span->end),
                        " s (", DatedDuration(span->begin, span->end), "); +0:+10 are the first ten seconds");
}

std::string MissText(const Selection& selection, const HeldSource& input, const ReadOptions& read) {
  if (std::isfinite(selection.begin_time) || std::isfinite(selection.end_time))
    return NoKeyframeIn(selection, ReadSpan(input, read, selection.map));
  return "has no keyframe of these ids";
}

}  // namespace slamdb::cli
