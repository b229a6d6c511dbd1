// SPDX-License-Identifier: BSD-3-Clause
// Thresholds are those at which no wrong pose passed, of look-alike rooms either; see docs/locate.md.
#include <algorithm>
#include <numbers>
#include <string>

#include "slamdb/align/detail/decide.h"
#include "slamdb/align/detail/deviation.h"
#include "slamdb/base/detail/concat.h"

namespace slamdb {
namespace {

constexpr std::uint64_t kFewestInliers = 30, kPoorInliers = 15;
constexpr double kCellShare = 0.70, kPoorCellShare = 0.4;
constexpr double kFoundShare = 0.20, kPoorFoundShare = 0.10;
constexpr double kExtent = 0.10;
constexpr double kMostDegrees = 0.22;                              // standard deviation of the rotation, or
constexpr double kSpread = 0.16;                                   // points all over the picture
constexpr double kSmallExtent = 0.15, kSmallExtentDegrees = 0.28;  // of a narrow view, which any patch fills
constexpr double kMostInFront = 0.15;
constexpr double kMostContradicting = 0.5;  // of the inliers

// A picture shows no more points than it has keypoints, however many a map has there: one of several sessions has most
// things more than once.
double FoundShare(const LocateEvidence& evidence) {
  const auto visible = static_cast<double>(evidence.visible), features = static_cast<double>(evidence.features);
  return visible > features && features > 0 ? std::min(1.0, evidence.found_share * visible / features)
                                            : evidence.found_share;
}

}  // namespace

std::string_view NameOf(LocateVerdict verdict) {
  switch (verdict) {
    case LocateVerdict::kFound:
      return "found";
    case LocateVerdict::kDoubtful:
      return "doubtful";
    case LocateVerdict::kNotFound:
      return "not-found";
    case LocateVerdict::kUnreadable:
      return "unreadable";
  }
  return {};
}

PosePrecision PrecisionOf(const Localization& localization) {
  const auto& covariance = localization.covariance;
  return {detail::LargestDeviation(covariance, 0) * 180 / std::numbers::pi, detail::LargestDeviation(covariance, 3)};
}

namespace detail {

void GiveVerdict(Localization& localization) {
  const LocateEvidence& evidence = localization.evidence;
  const auto say = [&](LocateVerdict verdict, std::string reason) {
    localization.verdict = verdict;
    localization.reason = std::move(reason);
  };
  const double found_share = FoundShare(evidence);
  const std::string found = Concat(Percent(found_share), " of the points that the picture must show are found, in ",
                                   Percent(evidence.cell_share), " of its parts");
  if (evidence.front_share > kMostInFront)
    return say(LocateVerdict::kNotFound, "points of the map would hide what the picture shows");
  if (evidence.checked_share == 0)
    return say(LocateVerdict::kNotFound, "too few points of the map must show in it to tell");
  if (evidence.cell_share < kPoorCellShare || found_share < kPoorFoundShare)
    return say(LocateVerdict::kNotFound, "the picture contradicts it: only " + found);
  if (evidence.inliers < kPoorInliers) return say(LocateVerdict::kNotFound, "too few points agree");
  if (evidence.cell_share < kCellShare || found_share < kFoundShare)
    return say(LocateVerdict::kDoubtful, "the picture half confirms it: " + found);
  if (evidence.extent < kExtent)
    return say(LocateVerdict::kDoubtful, "all that agrees is in one small patch, which may be a look-alike");
  const double degrees = PrecisionOf(localization).rotation_degrees;
  if ((degrees > kMostDegrees && evidence.spread < kSpread) ||
      (degrees > kSmallExtentDegrees && evidence.extent < kSmallExtent))
    return say(LocateVerdict::kDoubtful,
               "what agrees is in one part of the picture or of what it shows, and leaves the pose uncertain");
  if (evidence.inliers < kFewestInliers) return say(LocateVerdict::kDoubtful, "few points agree");
  if (static_cast<double>(evidence.contradicting) > kMostContradicting * static_cast<double>(evidence.inliers))
    return say(LocateVerdict::kDoubtful, "another place of the map looks the same");
  say(LocateVerdict::kFound, found);
}

}  // namespace detail
}  // namespace slamdb
