// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/align_text.h"

#include <algorithm>
#include <cmath>

#include "cli/report/layout.h"
#include "cli/report/optimize_text.h"
#include "cli/report/similarity.h"

namespace slamdb::cli {
namespace {

std::string UseText(LinkUse use) {
  switch (use) {
    case LinkUse::kJoins:
      return {};
    case LinkUse::kCloses:
      return ", as other maps have it";
    case LinkUse::kContradicts:
      return ", but links with other maps contradict it";
    case LinkUse::kUnused:
      return {};
  }
  return {};
}

std::string PrecisionText(const Alignment& alignment, bool metric) {
  const AlignmentPrecision precision = PrecisionOf(alignment);
  std::string text =
      "known to " + Short(precision.rotation_degrees, 2) + " degrees, " +
      (metric ? Short(1000 * precision.translation, 2) + " mm" : Short(precision.translation, 2) + " units");
  if (alignment.scale_is_free) text += ", " + Short(100 * precision.scale, 2) + "% of the scale";
  return text + ", if the maps are not bent themselves";
}

std::string EvidenceText(const Alignment& alignment) {
  const AlignmentEvidence& evidence = alignment.evidence;
  std::string text = Grouped(evidence.agreeing) + " of " +
                     Counted(evidence.candidates, "pair of keyframes", "pairs of keyframes") + " compared agree";
  if (evidence.contradicting > 0) text += ", " + Grouped(evidence.contradicting) + " on something else";
  text += "; " + Counted(evidence.points, "point") + " matched, within " + Short(evidence.rms, 2) +
          " sigma; near views of " + std::to_string(std::lround(100 * evidence.overlap)) +
          "% of the second's keyframes";
  if (!alignment.pairs.empty()) {
    const AlignedPair& best = alignment.pairs.front();
    text += "; the most alike: " + ToString(best.first) + " and " + ToString(best.second) + ", " +
            Counted(best.inliers, "point");
  }
  return text;
}

std::string LinkText(const MapLink& link, const std::vector<MapName>& names, const std::vector<bool>& metric) {
  const Alignment& alignment = link.alignment;
  std::string text = NameText(names[link.second]) + " in " + NameText(names[link.first]) + ": " +
                     std::string(NameOf(alignment.verdict)) + UseText(link.use) + "\n" + Wrapped(alignment.reason, 2);
  if (!alignment.first_from_second) return text;
  const bool sure = alignment.verdict == AlignmentVerdict::kAligned;
  text += Wrapped((sure ? "" : "the best guess: ") +
                      SimilarityText(*alignment.first_from_second, metric[link.first] ? " m" : " units"),
                  2);
  if (sure) text += Wrapped(PrecisionText(alignment, metric[link.first]), 2);
  return text + Wrapped(EvidenceText(alignment), 2);
}

}  // namespace

std::string AlignText(const AlignedMaps& aligned, const std::vector<MapName>& names, const std::vector<bool>& metric) {
  std::string text;
  for (const MapLink& link : aligned.links) text += LinkText(link, names, metric);
  if (names.size() <= 2) return text;
  for (std::size_t group = 0; group < names.size(); ++group) {
    std::string members;
    std::size_t count = 0;
    for (std::size_t map = 0; map < names.size(); ++map)
      if (aligned.places[map].group == group) {
        members += (count++ == 0 ? "" : ", ") + NameText(names[map]);
      }
    if (count > 0) text += (count == 1 ? "alone: " : "in one frame: ") + members + "\n";
  }
  return text;
}

std::string UnlikeText(const SearchedStore& store) {
  const auto list = [](const std::vector<std::string>& atlases) {
    std::string text;
    for (const std::string& atlas : atlases) text += (text.empty() ? "" : ", ") + atlas;
    return text;
  };
  std::string text;
  if (!store.unlike.empty()) text += Wrapped("nothing looks alike: " + list(store.unlike), 0);
  if (!store.unknown.empty())
    text += Wrapped("not asked, as the store does not know what they look like: " + list(store.unknown), 0);
  if (!store.unreachable.empty())
    text += Wrapped(
        "not asked, as their server does not answer ('slamdb fleet status' tells more): " + list(store.unreachable), 0);
  return text;
}

std::string OptimizedJoinText(const std::vector<OptimizedJoin>& rounds) {
  std::string text;
  for (const OptimizedJoin& round : rounds) {
    text += OptimizeText({.maps = {round.optimization}});
    text += "  across        " + Counted(round.observations, "observation") + " of points of other maps added, " +
            Counted(round.fused.fused, "point") + " fused\n";
  }
  return text;
}

}  // namespace slamdb::cli
