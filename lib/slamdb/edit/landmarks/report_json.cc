// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/json.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

detail::Json IdsJson(const std::vector<LandmarkId>& ids) {
  detail::Json json = detail::Json::array();
  for (const LandmarkId id : ids) json.push_back(detail::JsonId(id));
  return json;
}

}  // namespace

std::string ToJson(const MakeLandmarksReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("landmarks", files);
  json["from_points"] = {
      {"landmarks", report.landmarks}, {"undetermined", report.undetermined}, {"bad_points", report.bad}};
  return detail::JsonText(json);
}

std::string ToJson(const MakePointsReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("landmarks", files);
  json["to_points"] = {{"moved", report.moved},      {"added", report.added},     {"plain", report.plain},
                       {"fused", report.fused},      {"renamed", report.renamed}, {"turned", report.turned},
                       {"unturned", report.unturned}};
  return detail::JsonText(json);
}

std::string ToJson(const LayLandmarksReport& report, const ReportFiles& files, const std::string& from) {
  detail::Json json = detail::ReportHead("landmarks", files);
  json["into"] = {{"landmarks_from", detail::TextOrNull(from)},
                  {"moved", report.moved},
                  {"same", report.same},
                  {"taken", report.taken},
                  {"counts", report.counts},
                  {"without", report.without},
                  {"added", report.added},
                  {"turned", report.turned},
                  {"unturned", report.unturned},
                  {"not_there", IdsJson(report.not_there)},
                  {"ambiguous", IdsJson(report.ambiguous)},
                  {"infinite", IdsJson(report.infinite)}};
  return detail::JsonText(json);
}

}  // namespace slamdb
