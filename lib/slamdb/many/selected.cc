// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/selected.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/select.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/content.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::SecondsText;

// `17.9 s from 2014-06-24 19:02:59 UTC`.
std::string DatedDuration(const TimeSpan& span) {
  const std::string date = detail::DateText(span.begin);
  return detail::DurationText(span.end - span.begin) + (date.empty() ? "" : " from " + date);
}

}  // namespace

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

std::optional<TimeSpan> ReadSpan(const HeldSource& input, ReadOptions read, const std::optional<MapId>& map) {
  read.selection = {};
  read.features = FeatureColumns::kNone;
  return SpanOf(ReadAtlas(input, read), map ? std::optional(map->value()) : std::nullopt);
}

std::string NoKeyframeIn(const Selection& selection, const std::optional<TimeSpan>& span) {
  std::string text = "has no keyframe";
  if (std::isfinite(selection.begin_time)) text += " from " + SecondsText(selection.begin_time) + " s";
  if (std::isfinite(selection.end_time)) text += " to " + SecondsText(selection.end_time) + " s";
  if (!span) return text + "; none has a time";
  return detail::Concat(text, "; its keyframes are from ", SecondsText(span->begin), " to ", SecondsText(span->end),
                        " s (", DatedDuration(*span), "); +0:+10 are the first ten seconds");
}

std::string MissText(const Selection& selection, const HeldSource& input, const ReadOptions& read) {
  if (std::isfinite(selection.begin_time) || std::isfinite(selection.end_time))
    return NoKeyframeIn(selection, ReadSpan(input, read, selection.map));
  return "has no keyframe of these ids";
}

void RefuseEmptySelection(const Atlas& atlas, const std::string& name, const HeldSource& input,
                          const ReadOptions& read) {
  const Selection& selection = read.selection;
  if (selection.map && atlas.maps.empty())
    throw Error(ErrorKind::kNotFound, name, "", "has no " + ToString(*selection.map));
  const Substance selected = SubstanceOf(atlas, /*with_bad=*/true);
  if (selected.landmarks) return;
  if ((selection.has_keyframe_range() && !selected.keyframes) || (selection.box && !selected.points))
    throw Error(ErrorKind::kNotFound, name, "",
                selected.keyframes ? "has no points in the box" : MissText(selection, input, read));
}

Atlas ReadPartToShow(const std::string& name, const HeldSource& input, const ReadOptions& read, Notices& notices) {
  Atlas atlas = ReadAtlas(input, read, &notices);
  RefuseEmptySelection(atlas, name, input, read);
  if (!read.selection.has_keyframe_range() || !SubstanceOf(atlas, /*with_bad=*/true).keyframes) return atlas;
  const Subset seen = Select(AtlasIndex(atlas));  // observations of keyframes that were not read lead nowhere
  KeepSubset(atlas, seen, read.threads);
  return atlas;
}

}  // namespace slamdb
