// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"
#include "slamdb/checks/detail/json.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

using detail::Json;
using detail::JsonNumber;

Json PlaceJson(const Place& place) {
  Json json = Json::object();
  if (place.map) json["map"] = JsonNumber(place.map.value());
  if (place.keyframe) json["keyframe"] = JsonNumber(place.keyframe.value());
  if (place.point) json["point"] = JsonNumber(place.point.value());
  if (place.camera) json["camera"] = JsonNumber(place.camera.value());
  if (place.landmark) json["landmark"] = JsonNumber(place.landmark.value());
  if (place.feature >= 0) json["feature"] = place.feature;
  return json;
}

Json ResultJson(const RuleResult& result) {
  Json json;
  json["rule"] = result.id;
  json["severity"] = ToString(result.severity);
  json["title"] = result.title;
  if (!result.consequence.empty()) json["consequence"] = detail::Concat("ORB-SLAM3 ", result.consequence);
  if (!result.fix.empty()) json["fix"] = result.fix;
  json["count"] = result.count;
  json["findings"] = Json::array();
  for (const Finding& finding : result.findings) json["findings"].push_back(detail::JsonOf(finding));
  return json;
}

// What the quality gates measure.
Json MeasuresJson(const AtlasStatistics& statistics) {
  Json json = Json::object();
  for (const Gate& gate : ReadGates()) json[std::string(gate.measure_name)] = gate.measure(statistics);
  return json;
}

Json FileJson(const CheckedFile& file) {
  Json json;
  json["input"] = file.name;
  if (!file.failure.empty()) {
    json["failure"] = file.failure;
    return json;
  }
  const CheckReport& report = file.report;
  json["sound"] = report.ok();
  json["severities"] = Json::object();
  for (const Severity severity : {Severity::kError, Severity::kWarning, Severity::kNote})
    json["severities"][std::string(ToString(severity))] = report.Count(severity);
  json["checked"] = report.checked;
  json["measures"] = MeasuresJson(report.statistics);
  json["results"] = Json::array();
  for (const RuleResult& result : report.results) json["results"].push_back(ResultJson(result));
  return json;
}

}  // namespace

Json detail::JsonOf(const Finding& finding) {
  return {{"place", PlaceJson(finding.place)}, {"where", ToString(finding.place)}, {"message", finding.message}};
}

std::string ToJson(std::span<const CheckedFile> files) {
  Json json = detail::ReportHead("check");
  json["inputs"] = Json::array();
  for (const CheckedFile& file : files) json["inputs"].push_back(FileJson(file));
  return detail::JsonText(json);
}

std::string JsonCatalogue() {
  Json json = detail::ReportHead("rules");
  json["rules"] = Json::array();
  for (const Rule& rule : ReadRules()) {
    Json entry{{"id", rule.id},
               {"severity", ToString(rule.severity)},
               {"title", rule.title},
               {"consequence", detail::Concat("ORB-SLAM3 ", rule.consequence)}};
    if (rule.fix) entry["fix"] = rule.fix.name;
    json["rules"].push_back(std::move(entry));
  }
  json["gates"] = Json::array();
  for (const Gate& gate : ReadGates())
    json["gates"].push_back({{"id", gate.id},
                             {"bound", gate.is_minimum ? "minimum" : "maximum"},
                             {"measure", gate.measure_name},
                             {"title", gate.title}});
  return detail::JsonText(json);
}

}  // namespace slamdb
