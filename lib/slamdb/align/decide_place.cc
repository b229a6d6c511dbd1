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
// What a focal length must miss by, of itself and in standard deviations: pictures of flat things tell it badly.
constexpr double kOtherFocal = 0.02, kFocalDeviations = 5;

// A picture shows no more points than it has keypoints, however many a map has there: one of several sessions has most
// things more than once.
double FoundShare(const LocateEvidence& evidence) {
  const auto visible = static_cast<double>(evidence.visible), features = static_cast<double>(evidence.features);
  return visible > features && features > 0 ? std::min(1.0, evidence.found_share * visible / features)
                                            : evidence.found_share;
}

// Why a pose is refused; empty: it is not.
std::string RefusalOf(const LocateEvidence& evidence, const std::string& found) {
  if (evidence.front_share > kMostInFront) return "points of the map would hide what the picture shows";
  if (evidence.checked_share == 0) return "too few points of the map must show in it to tell";
  if (evidence.cell_share < kPoorCellShare || FoundShare(evidence) < kPoorFoundShare)
    return "the picture contradicts it: only " + found;
  if (evidence.inliers < kPoorInliers) return "too few points agree";
  return {};
}

// Why it is not sure; empty: it is.
std::string DoubtOf(const LocateEvidence& evidence, double degrees, const std::string& found) {
  if (evidence.cell_share < kCellShare || FoundShare(evidence) < kFoundShare)
    return "the picture half confirms it: " + found;
  if (evidence.extent < kExtent) return "all that agrees is in one small patch, which may be a look-alike";
  if ((degrees > kMostDegrees && evidence.spread < kSpread) ||
      (degrees > kSmallExtentDegrees && evidence.extent < kSmallExtent))
    return "what agrees is in one part of the picture or of what it shows, and leaves the pose uncertain";
  if (evidence.inliers < kFewestInliers) return "few points agree";
  if (static_cast<double>(evidence.contradicting) > kMostContradicting * static_cast<double>(evidence.inliers))
    return "another place of the map looks the same";
  const double off = std::abs(evidence.focal_factor - 1);
  if (off > kOtherFocal && off > kFocalDeviations * evidence.focal_deviation)
    return detail::Concat("the focal length that fits best is ", detail::Percent(evidence.focal_factor),
                          " of the camera's: did that camera take the picture?");
  return {};
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
  const std::string found =
      Concat(Percent(FoundShare(evidence)), " of the points that the picture must show are found, in ",
             Percent(evidence.cell_share), " of its parts");
  if (std::string refusal = RefusalOf(evidence, found); !refusal.empty()) {
    localization.verdict = LocateVerdict::kNotFound;
    localization.reason = std::move(refusal);
  } else if (std::string doubt = DoubtOf(evidence, PrecisionOf(localization).rotation_degrees, found); !doubt.empty()) {
    localization.verdict = LocateVerdict::kDoubtful;
    localization.reason = std::move(doubt);
  } else {
    localization.verdict = LocateVerdict::kFound;
    localization.reason = found;
  }
}

}  // namespace detail
}  // namespace slamdb
