// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

using detail::Json;

constexpr std::string_view kSchema =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

// A path as a relative or file URI: everything but unreserved characters and '/' percent-encoded (RFC 3986).
std::string Uri(std::string_view path) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri(path.starts_with('/') ? "file://" : "");
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    if (plain)
      uri += c;
    else
      uri += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return uri;
}

std::string QualifiedName(const Place& place) {
  std::string name;
  const auto append = [&](const char* kind, std::uint64_t id) {
    name += detail::Concat(name.empty() ? "" : "/", kind, "/", std::to_string(id));
  };
  if (place.map) append("map", place.map.value());
  if (place.keyframe) append("kf", place.keyframe.value());
  if (place.feature >= 0) append("feature", static_cast<std::uint64_t>(place.feature));
  if (place.point) append("mp", place.point.value());
  if (place.camera) append("camera", place.camera.value());
  if (place.landmark) append("landmark", place.landmark.value());
  return name.empty() ? "atlas" : name;
}

Json RuleJson(std::string_view id, std::string_view title, std::string_view help, Severity severity) {
  return {{"id", id},
          {"shortDescription", {{"text", title}}},
          {"help", {{"text", help}}},
          {"defaultConfiguration", {{"level", ToString(severity)}}}};
}

Json RulesJson() {
  Json rules = Json::array();
  for (const Rule& rule : ReadRules())
    rules.push_back(
        RuleJson(rule.id, rule.title, detail::Concat("Otherwise ORB-SLAM3 ", rule.consequence, "."), rule.severity));
  for (const Gate& gate : ReadGates())
    rules.push_back(RuleJson(GateRuleId(gate.id), detail::Concat("passes the quality gate ", gate.id),
                             "The limit is set on the command line.", Severity::kError));
  return rules;
}

std::size_t RuleIndex(const std::string& id) {
  const auto rules = ReadRules();
  const auto rule = std::ranges::find(rules, std::string_view(id), &Rule::id);
  if (rule != rules.end()) return static_cast<std::size_t>(rule - rules.begin());
  const auto gates = ReadGates();
  const auto gate = std::ranges::find_if(gates, [&](const Gate& candidate) { return GateRuleId(candidate.id) == id; });
  return rules.size() + static_cast<std::size_t>(gate - gates.begin());
}

Json LocationJson(const std::string& file, const Place& place) {
  return {{"physicalLocation", {{"artifactLocation", {{"uri", Uri(file)}}}}},
          {"logicalLocations", {{{"fullyQualifiedName", QualifiedName(place)}}}}};
}

void AppendResults(const CheckedFile& file, Json& results) {
  for (const RuleResult& result : file.report.results) {
    for (const Finding& finding : result.findings)
      results.push_back({{"ruleId", result.id},
                         {"ruleIndex", RuleIndex(result.id)},
                         {"level", ToString(result.severity)},
                         {"message", {{"text", detail::Concat(ToString(finding.place), ": ", finding.message)}}},
                         {"locations", {LocationJson(file.name, finding.place)}}});
    if (result.count > result.findings.size())
      results.push_back({{"ruleId", result.id},
                         {"ruleIndex", RuleIndex(result.id)},
                         {"level", ToString(result.severity)},
                         {"message",
                          {{"text", std::to_string(result.count - result.findings.size()) + " more findings of rule " +
                                        result.id + " are not listed"}}},
                         {"locations", {LocationJson(file.name, Place{})}}});
  }
}

}  // namespace

std::string SarifReport(std::span<const CheckedFile> files, const std::string& version) {
  Json results = Json::array(), notifications = Json::array();
  for (const CheckedFile& file : files) {
    AppendResults(file, results);
    if (file.failure.empty()) continue;
    notifications.push_back(
        {{"level", "error"},
         {"message", {{"text", file.failure}}},
         {"locations", {{{"physicalLocation", {{"artifactLocation", {{"uri", Uri(file.name)}}}}}}}}});
  }
  const Json driver{{"name", "slamdb"}, {"semanticVersion", version}, {"rules", RulesJson()}};
  Json run;
  run["tool"] = {{"driver", driver}};
  run["invocations"] =
      Json::array({{{"executionSuccessful", notifications.empty()}, {"toolExecutionNotifications", notifications}}});
  run["columnKind"] = "unicodeCodePoints";
  run["results"] = std::move(results);
  Json sarif;
  sarif["$schema"] = kSchema;
  sarif["version"] = "2.1.0";
  sarif["runs"] = Json::array({run});
  return detail::JsonText(sarif);
}

}  // namespace slamdb
