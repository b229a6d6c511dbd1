// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/warnings.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/content.h"

namespace slamdb {
namespace {

using detail::Counted;

template <class Report>
void WarnOfTurned(const Report& report, Notices& notices) {
  if (report.turned > 0)
    notices.Warn("the normals of " + Counted(report.turned, "landmark") +
                 " point away from the cameras, as earlier versions of slamdb made them; they were turned round");
  if (report.unturned > 0)
    notices.Warn("the normals of " + Counted(report.unturned, "landmark") +
                 " without a point that tells their direction were left as they are, since less than nine tenths of "
                 "the others had to be turned round");
}

// "3 landmarks ...: 4, 17, 23"; the first few of many.
void WarnOfLeftOut(const std::vector<LandmarkId>& ids, const std::string& why, Notices& notices) {
  constexpr std::size_t kShown = 5;
  if (ids.empty()) return;
  std::string text = Counted(ids.size(), "landmark") + " left out, " + why + ":";
  for (std::size_t i = 0; i < std::min(kShown, ids.size()); ++i)
    text += (i > 0 ? ", " : " ") + (ids[i] ? ToString(ids[i]) : std::string("one without id"));
  if (ids.size() > kShown) text += " and " + std::to_string(ids.size() - kShown) + " more";
  notices.Warn(text);
}

}  // namespace

void RequireLandmarks(const Atlas& atlas) {
  if (!SubstanceOf(atlas).landmarks)
    throw Error(ErrorKind::kNotPossible, "has no landmarks; `MakeLandmarks` makes them of points");
}

void RequireMade(const MakeLandmarksReport& report) {
  if (report.landmarks > 0) return;
  throw Error(ErrorKind::kNotPossible, report.bad > 0
                                           ? "all points are flagged bad, so there is none to make a landmark of"
                                           : "there are no points to make landmarks of");
}

void WarnOfUnobserved(std::uint64_t added, Notices& notices) {
  if (added > 0) notices.Warn("points without observations are for viewers and exports: ORB-SLAM3 crashes on them");
}

void TellWarnings(const MakePointsReport& report, Notices& notices) { WarnOfTurned(report, notices); }

void TellWarnings(const LayLandmarksReport& report, const std::string& into, Notices& notices) {
  WarnOfLeftOut(report.not_there, "since " + into + " has no point of the id", notices);
  WarnOfLeftOut(report.ambiguous, "since several maps have the id", notices);
  WarnOfLeftOut(report.infinite, "since they are at no finite place", notices);
  WarnOfTurned(report, notices);
}

}  // namespace slamdb
