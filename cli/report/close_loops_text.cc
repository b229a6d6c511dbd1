// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/close_loops_text.h"

#include "cli/report/layout.h"
#include "cli/report/optimize_text.h"

namespace slamdb::cli {
namespace {

std::string GapText(const LoopGap& gap) {
  std::string text = "off by " + Short(gap.translation, 3) + ", " + Short(gap.degrees, 2) + " degrees";
  if (gap.scale != 1) text += ", and " + Short(gap.scale, 3) + " in scale";
  return text;
}

std::string EvidenceText(const LoopEvidence& evidence) {
  std::string text = Counted(evidence.agreeing, "pair of keyframes agrees", "pairs of keyframes agree") + ", " +
                     Grouped(evidence.first_keyframes) + " earlier with " + Grouped(evidence.second_keyframes) +
                     " later";
  if (evidence.contradicting > 0) text += "; " + Grouped(evidence.contradicting) + " on something else";
  return text + "; " + Counted(evidence.points, "point") + " matched; " + Grouped(evidence.agreeing_views) + " of " +
         Counted(evidence.views, "picture") + " confirm it";
}

std::string LoopText(const Loop& loop) {
  const AlignedPair& best = loop.pairs.front();
  return "  " + std::string(NameOf(loop.verdict)) + ": " + ToString(best.second) + " is back at " +
         ToString(best.first) + "\n" + Wrapped(loop.reason, 4) + Wrapped(GapText(loop.gap), 4) +
         Wrapped(EvidenceText(loop.evidence), 4);
}

std::string MapText(const ClosedMap& map) {
  std::string text = ToString(map.map) + ": " + Counted(map.search.loops.size(), "revisit") + " among " +
                     Counted(map.search.candidates, "pair of keyframes", "pairs of keyframes") + " that look alike\n";
  for (const Loop& loop : map.search.loops) text += LoopText(loop);
  if (map.constraints == 0) return text;
  text += Wrapped("closed by " + Counted(map.constraints, "pair of keyframes", "pairs of keyframes") + "; " +
                      Counted(map.fused.fused, "point") + " of both ends fused",
                  2);
  return text + OptimizeText({.maps = {map.optimization}});
}

}  // namespace

std::string CloseLoopsText(const CloseLoopsReport& report) {
  std::string text;
  for (const ClosedMap& map : report.maps) text += MapText(map);
  return text + (report.closed > 0 ? "" : "no loop to close\n");
}

}  // namespace slamdb::cli
