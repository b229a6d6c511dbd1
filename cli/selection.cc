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

}  // namespace slamdb::cli
