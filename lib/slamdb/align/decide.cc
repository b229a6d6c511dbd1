// SPDX-License-Identifier: BSD-3-Clause
// Thresholds are those at which no wrong pair of real maps passed, look-alike rooms among them; see docs/align.md.
#include "slamdb/align/detail/decide.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "slamdb/align/detail/deviation.h"
#include "slamdb/base/detail/concat.h"

namespace slamdb {
namespace {

constexpr double kCellShare = 0.85, kPoorCellShare = 0.75;
constexpr double kFoundShare = 0.20, kPoorFoundShare = 0.15;
constexpr double kExtent = 0.15;
constexpr double kMostInFront = 0.15;
constexpr std::uint64_t kFewestKeyframes = 3, kFewestPoints = 50, kFewestViews = 3;
constexpr double kMostContradicting = 0.35;  // of those that agree
constexpr double kMostDegrees =
    0.3;  // standard deviation: what is less well known is off by centimetres a few metres away

}  // namespace

std::string_view NameOf(AlignmentVerdict verdict) {
  switch (verdict) {
    case AlignmentVerdict::kAligned:
      return "aligned";
    case AlignmentVerdict::kDoubtful:
      return "doubtful";
    case AlignmentVerdict::kNoOverlap:
      return "no-overlap";
  }
  return {};
}

AlignmentPrecision PrecisionOf(const Alignment& alignment) {
  const auto& covariance = alignment.covariance;
  return {detail::LargestDeviation(covariance, 0) * 180 / std::numbers::pi, detail::LargestDeviation(covariance, 3),
          std::sqrt(std::max(0.0, covariance(6, 6)))};
}

namespace detail {

std::string Percent(double share) { return Fixed(100 * share, 0) + "%"; }

Alignment NothingAgrees() { return {.reason = "no two keyframes see the same"}; }

bool PicturesConfirm(const AlignmentEvidence& evidence) {
  return evidence.cell_share >= kCellShare && evidence.found_share >= kFoundShare &&
         evidence.agreeing_views >= kFewestViews && evidence.front_share <= kMostInFront;
}

void GiveVerdict(Alignment& alignment) {
  const AlignmentEvidence& evidence = alignment.evidence;
  const auto say = [&](AlignmentVerdict verdict, std::string reason) {
    alignment.verdict = verdict;
    alignment.reason = std::move(reason);
  };
  const std::string found = Percent(evidence.found_share) +
                            " of the points that pictures of the other map must show "
                            "are found, in " +
                            Percent(evidence.cell_share) + " of the parts of these pictures";
  if (evidence.front_share > kMostInFront)
    return say(AlignmentVerdict::kNoOverlap,
               Percent(evidence.front_share) + " of the points would hide what the other map sees");
  if (evidence.cell_share < kPoorCellShare || evidence.found_share < kPoorFoundShare)
    return say(AlignmentVerdict::kNoOverlap, "the pictures contradict it: only " + found);
  if (evidence.agreeing_views < kFewestViews)
    return say(AlignmentVerdict::kNoOverlap, "too few pictures of either map confirm it");
  if (evidence.cell_share < kCellShare || evidence.found_share < kFoundShare)
    return say(AlignmentVerdict::kDoubtful, "the pictures half confirm it: " + found);
  if (evidence.extent < kExtent)
    return say(AlignmentVerdict::kDoubtful, "all that agrees is in one small patch, which may be a look-alike");
  if (evidence.keyframes < kFewestKeyframes || evidence.points < kFewestPoints)
    return say(AlignmentVerdict::kDoubtful, "too few keyframes or points agree");
  if (static_cast<double>(evidence.contradicting) > kMostContradicting * static_cast<double>(evidence.agreeing))
    return say(AlignmentVerdict::kDoubtful, "other pairs of keyframes agree on another transform");
  if (PrecisionOf(alignment).rotation_degrees > kMostDegrees)
    return say(AlignmentVerdict::kDoubtful,
               "what agrees is too little to tell how the maps lie: their rotation is not known well");
  say(AlignmentVerdict::kAligned, found);
}

}  // namespace detail
}  // namespace slamdb
