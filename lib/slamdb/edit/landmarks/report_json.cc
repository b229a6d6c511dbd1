// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/json.h"
#include "slamdb/edit/landmarks/landmarks.h"

namespace slamdb {

std::string ToJson(const MakeLandmarksReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("landmarks", files);
  json["from_points"] = {
      {"landmarks", report.landmarks}, {"undetermined", report.undetermined}, {"bad_points", report.bad}};
  return detail::JsonText(json);
}

std::string ToJson(const MakePointsReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("landmarks", files);
  json["to_points"] = {{"moved", report.moved},
                       {"added", report.added},
                       {"plain", report.plain},
                       {"fused", report.fused},
                       {"renamed", report.renamed}};
  return detail::JsonText(json);
}

}  // namespace slamdb
