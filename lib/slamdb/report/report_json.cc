// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/json.h"
#include "slamdb/report/pages.h"

namespace slamdb {
namespace {

using detail::Json;

Json InputJson(const AtlasReport& report) {
  Json json{{"input", report.checked.name}, {"page", detail::TextOrNull(report.page)}};
  if (!report.checked.failure.empty()) {
    json["failure"] = report.checked.failure;
    return json;
  }
  const CheckReport& check = report.checked.report;
  json["sound"] = check.ok();
  json["severities"] = Json::object();
  for (const Severity severity : {Severity::kError, Severity::kWarning, Severity::kNote})
    json["severities"][std::string(ToString(severity))] = check.Count(severity);
  json["maps"] = check.statistics.maps.size();
  json["keyframes"] = check.statistics.keyframes;
  json["points"] = check.statistics.points;
  json["trajectory_length"] = check.statistics.trajectory_length;
  return json;
}

}  // namespace

std::string ToJson(std::span<const AtlasReport> reports, const std::string& output) {
  Json json = detail::ReportHead("report");
  json["inputs"] = Json::array();
  for (const AtlasReport& report : reports) json["inputs"].push_back(InputJson(report));
  json["output"] = detail::TextOrNull(output);
  return detail::JsonText(json);
}

}  // namespace slamdb
