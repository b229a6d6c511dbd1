// SPDX-License-Identifier: BSD-3-Clause
// Thresholds are those at which no wrong loop of real maps passed, look-alike rooms among them; see
// docs/close-loops.md.
#include <algorithm>
#include <cmath>
#include <string>

#include "slamdb/align/detail/decide.h"
#include "slamdb/align/loops.h"

namespace slamdb {
namespace {

constexpr double kCellShare = 0.85, kPoorCellShare = 0.75;
constexpr double kFoundShare = 0.28, kPoorFoundShare = 0.20;
constexpr double kExtent = 0.15;
constexpr double kMostInFront = 0.15;
constexpr std::uint64_t kFewestPairs = 3, kFewestKeyframes = 2, kFewestPoints = 50, kFewestViews = 3;
constexpr double kMostContradicting = 0.35;  // of those that agree
constexpr double kMostDrift = 0.1;           // of the way between the ends; farther apart are places that look alike

// What pictures cannot tell from nothing, and neighbours in a map are off by anyway.
constexpr double kClosedShift = 0.02, kClosedDegrees = 1, kClosedScale = 0.02;  // shift in median depths

bool IsClosed(const LoopGap& gap, double depth) {
  return gap.translation < kClosedShift * depth && gap.degrees < kClosedDegrees &&
         std::abs(std::log(gap.scale)) < kClosedScale;
}

}  // namespace

std::string_view NameOf(LoopVerdict verdict) {
  switch (verdict) {
    case LoopVerdict::kMissed:
      return "missed";
    case LoopVerdict::kClosed:
      return "closed";
    case LoopVerdict::kDoubtful:
      return "doubtful";
    case LoopVerdict::kRefuted:
      return "refuted";
  }
  return {};
}

namespace detail {

void GiveVerdict(Loop& loop, double depth) {
  const LoopEvidence& evidence = loop.evidence;
  const auto say = [&](LoopVerdict verdict, std::string reason) {
    loop.verdict = verdict;
    loop.reason = std::move(reason);
  };
  const std::string found = Percent(evidence.found_share) +
                            " of the points that pictures of the other end must show are found, in " +
                            Percent(evidence.cell_share) + " of the parts of these pictures";
  if (IsClosed(loop.gap, depth)) return say(LoopVerdict::kClosed, "the map has both ends where the pictures do");
  if (evidence.front_share > kMostInFront)
    return say(LoopVerdict::kRefuted,
               Percent(evidence.front_share) + " of the points would hide what the other end sees");
  if (evidence.cell_share < kPoorCellShare || evidence.found_share < kPoorFoundShare)
    return say(LoopVerdict::kRefuted, "the pictures contradict it: only " + found);
  if (evidence.agreeing_views < kFewestViews)
    return say(LoopVerdict::kRefuted, "too few pictures of either end confirm it");
  if (evidence.cell_share < kCellShare || evidence.found_share < kFoundShare)
    return say(LoopVerdict::kDoubtful, "the pictures half confirm it: " + found);
  if (evidence.extent < kExtent)
    return say(LoopVerdict::kDoubtful, "all that agrees is in one small patch, which may be a look-alike");
  if (evidence.agreeing < kFewestPairs ||
      std::min(evidence.first_keyframes, evidence.second_keyframes) < kFewestKeyframes ||
      evidence.points < kFewestPoints)
    return say(LoopVerdict::kDoubtful, "too few keyframes or points agree");
  if (static_cast<double>(evidence.contradicting) > kMostContradicting * static_cast<double>(evidence.agreeing))
    return say(LoopVerdict::kDoubtful, "other pairs of keyframes at the same ends agree on another transform");
  if (loop.gap.translation > kMostDrift * loop.gap.path)
    return say(LoopVerdict::kDoubtful,
               "the ends are " + Percent(loop.gap.translation / std::max(loop.gap.path, 1e-9)) +
                   " of the way between them apart, farther than maps drift: the place may repeat itself");
  say(LoopVerdict::kMissed, found);
}

}  // namespace detail
}  // namespace slamdb
