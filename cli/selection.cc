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

using detail::SecondsText;

using detail::Concat;
using detail::ParseNumber;

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

std::string CheckBox(const std::string& text) {
  return ParseBox(text) ? std::string() : "expected two corners as X,Y,Z:X,Y,Z, found '" + text + "'";
}

void SelectTimes(const TimeRange& range, const std::optional<TimeSpan>& span, Selection& selection) {
  if (range.is_relative() && !span)
    throw Error(ErrorKind::kNotPossible, "--time counts from keyframes, of which none has a time");
  const TimeSpan times = range.In(span.value_or(TimeSpan()));
  selection.begin_time = times.begin;
  selection.end_time = times.end;
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
  AddIdRange(verb, options.keyframes, "Only keyframes of these ids")->group(kGroup);
  AddTimeRange(verb, options.time, "Only keyframes of this time span")->group(kGroup);
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
  return !options.time.empty() && ParseTimeRange(options.time).value().is_relative();
}

Selection ParseSelection(const SelectionOptions& options, const std::optional<TimeSpan>& span) {
  Selection selection;
  if (options.map) selection.map = MapId(*options.map);
  if (!options.keyframes.empty()) {
    const MapQuery::Ids ids = ParseIdRange(options.keyframes).value();
    selection.first_keyframe = ids.first;
    selection.last_keyframe = ids.last;
  }
  if (!options.time.empty()) SelectTimes(ParseTimeRange(options.time).value(), span, selection);
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
