// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <nlohmann/json.hpp>

#include "slamdb/base/detail/concat.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

using Json = nlohmann::ordered_json;

// Numbers up to 2^53 survive every JSON reader; larger ones only as text.
Json Number(std::uint64_t value) {
  constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
  return value <= kExact ? Json(value) : Json(std::to_string(value));
}

Json PlaceJson(const Place& place) {
  Json json = Json::object();
  if (place.map) json["map"] = Number(place.map.value());
  if (place.keyframe) json["keyframe"] = Number(place.keyframe.value());
  if (place.point) json["point"] = Number(place.point.value());
  if (place.camera) json["camera"] = Number(place.camera.value());
  if (place.landmark) json["landmark"] = Number(place.landmark.value());
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
  for (const Finding& finding : result.findings)
    json["findings"].push_back(
        {{"place", PlaceJson(finding.place)}, {"where", ToString(finding.place)}, {"message", finding.message}});
  return json;
}

// What the quality gates measure, under their names without the bound.
Json MeasuresJson(const AtlasStatistics& statistics) {
  Json json = Json::object();
  for (const Gate& gate : ReadGates()) {
    std::string name(gate.id.substr(4));
    std::ranges::replace(name, '-', '_');
    json[name] = gate.measure(statistics);
  }
  return json;
}

Json FileJson(const CheckedFile& file) {
  Json json;
  json["file"] = file.name;
  if (!file.failure.empty()) {
    json["failure"] = file.failure;
    return json;
  }
  const CheckReport& report = file.report;
  json["ok"] = report.ok();
  json["errors"] = report.Count(Severity::kError);
  json["warnings"] = report.Count(Severity::kWarning);
  json["notes"] = report.Count(Severity::kNote);
  json["checked"] = report.checked;
  json["measures"] = MeasuresJson(report.statistics);
  json["results"] = Json::array();
  for (const RuleResult& result : report.results) json["results"].push_back(ResultJson(result));
  return json;
}

// File names may hold any bytes; what is not UTF-8 is replaced.
std::string Text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string JsonReport(std::span<const CheckedFile> files) {
  Json json;
  json["format"] = "slamdb-check-1";
  json["files"] = Json::array();
  for (const CheckedFile& file : files) json["files"].push_back(FileJson(file));
  return Text(json);
}

std::string JsonCatalogue() {
  Json json;
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
    json["gates"].push_back(
        {{"id", gate.id}, {"bound", gate.is_minimum ? "minimum" : "maximum"}, {"title", gate.title}});
  return Text(json);
}

}  // namespace slamdb
