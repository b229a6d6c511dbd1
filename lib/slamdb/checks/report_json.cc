// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <concepts>
#include <limits>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json_list.h"
#include "slamdb/checks/detail/json.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

using detail::Json;
using detail::JsonNumber;

constexpr std::string_view kSubject = "ORB-SLAM3 ";  // of consequences

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
  if (!result.consequence.empty()) json["consequence"] = detail::Concat(kSubject, result.consequence);
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

// What JsonNumber made: text only beyond what every reader of JSON holds.
template <std::unsigned_integral Integer>
Integer NumberOf(const Json& json) {
  const auto number = detail::IntegerOf<Integer>(json);
  if (JsonNumber(number) != json)
    throw Error(ErrorKind::kDamaged,
                detail::Concat(detail::Dumped(json), " is no number; expected ", detail::Dumped(JsonNumber(number))));
  return number;
}

template <class Entity>
void TakeId(const Json& json, Id<Entity>& id) {
  id = Id<Entity>(NumberOf<std::uint64_t>(json));
}

void TakeMember(const std::string& key, const Json& value, Place& place) {
  if (key == "map") return TakeId(value, place.map);
  if (key == "keyframe") return TakeId(value, place.keyframe);
  if (key == "point") return TakeId(value, place.point);
  if (key == "camera") return TakeId(value, place.camera);
  if (key == "landmark") return TakeId(value, place.landmark);
  if (key != "feature")
    throw Error(ErrorKind::kDamaged, "is none of map, keyframe, point, camera, landmark and feature");
  place.feature = std::int64_t{NumberOf<std::uint32_t>(value)};
}

Place PlaceOf(const Json& json) {
  Place place;
  for (const auto& [key, value] : json.get_ref<const Json::object_t&>())
    detail::InPart(key, [&, &name = key, &member = value] { TakeMember(name, member, place); });
  return place;
}

Severity SeverityOf(const std::string& word) {
  for (const Severity severity : {Severity::kNote, Severity::kWarning, Severity::kError})
    if (word == ToString(severity)) return severity;
  throw Error(ErrorKind::kDamaged, detail::Concat("'", word, "' is no severity"));
}

RuleResult ResultOf(const Json& json) {
  RuleResult result{.id = json.at("rule"),
                    .severity = SeverityOf(json.at("severity")),
                    .title = json.at("title"),
                    .consequence = json.value("consequence", ""),
                    .fix = json.value("fix", ""),
                    .count = detail::IntegerOf<std::uint64_t>(json.at("count")),
                    .findings = {}};
  if (result.consequence.starts_with(kSubject)) result.consequence.erase(0, kSubject.size());
  detail::ForEachItem(json.at("findings"), "findings",
                      [&](const Json& finding) { result.findings.push_back(detail::FindingOf(finding)); });
  return result;
}

// Atlases of which the gates measure the same.
AtlasStatistics StatisticsOf(const Json& measures) {
  const auto number = [&](const char* name) {
    const Json& measure = measures.at(name);
    return measure.is_null() ? std::numeric_limits<double>::quiet_NaN() : measure.get<double>();
  };
  AtlasStatistics statistics;
  statistics.maps.resize(std::max<std::size_t>(1, static_cast<std::size_t>(number("maps"))));
  if (number("maps") > 0)
    for (MapStatistics& map : statistics.maps) map.keyframes = 1;
  statistics.keyframes = static_cast<std::uint64_t>(number("keyframes"));
  statistics.points = static_cast<std::uint64_t>(number("points"));
  statistics.trajectory_length = number("trajectory_length");
  MapStatistics& first = statistics.maps.front();
  first.components = static_cast<std::uint64_t>(number("components"));
  first.end_time = number("duration_s");
  first.observers = {.count = 1, .mean = number("observers_per_point")};
  first.reprojection_error = {.count = 1, .mean = number("reprojection_error_px")};
  return statistics;
}

class JsonReporter : public CheckReporter {
 public:
  explicit JsonReporter(Sink sink) : inputs_(detail::ReportHead("check"), "inputs", std::move(sink)) {}

  void Add(const CheckedFile& file) override { inputs_.Add(detail::JsonOf(file)); }
  void End() override { inputs_.End(); }

 private:
  detail::JsonListWriter inputs_;
};

}  // namespace

Json detail::JsonOf(const Finding& finding) {
  return {{"place", PlaceJson(finding.place)}, {"where", ToString(finding.place)}, {"message", finding.message}};
}

void detail::InPart(const std::string& part, const std::function<void()>& work) {
  const auto fail = [&](const std::string& inner, const std::string& problem) {
    const bool is_whole = inner.empty() || inner.front() == '[';
    throw Error(ErrorKind::kDamaged, "", Concat(part, is_whole ? "" : ".", inner), problem);
  };
  try {
    work();
  } catch (const Error& error) {
    fail(error.place(), error.problem());
  } catch (const Json::exception& error) {
    fail("", error.what());
  }
}

void detail::ForEachItem(const Json& list, const std::string& name, const std::function<void(const Json&)>& take) {
  if (!list.is_array()) throw Error(ErrorKind::kDamaged, "", name, Concat("is ", Dumped(list), ", and no list"));
  for (std::size_t i = 0; i < list.size(); ++i) InPart(Concat(name, "[", i, "]"), [&] { take(list[i]); });
}

Finding detail::FindingOf(const Json& json) {
  Finding finding{.place = {}, .message = json.at("message")};
  InPart("place", [&] { finding.place = PlaceOf(json.at("place")); });
  return finding;
}

Json detail::JsonOf(const CheckedFile& file) {
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

CheckedFile detail::CheckedFileOf(const Json& json) {
  CheckedFile file{.name = json.at("input"), .report = {}, .failure = json.value("failure", ""), .file = {}};
  if (!file.failure.empty()) return file;
  ForEachItem(json.at("results"), "results",
              [&](const Json& result) { file.report.results.push_back(ResultOf(result)); });
  json.at("checked").get_to(file.report.checked);
  file.report.statistics = StatisticsOf(json.at("measures"));
  return file;
}

std::unique_ptr<CheckReporter> MakeJsonReporter(CheckReporter::Sink sink) {
  return std::make_unique<JsonReporter>(std::move(sink));
}

std::string ToJson(std::span<const CheckedFile> files) {
  std::string text;
  JsonReporter reporter([&](std::string_view piece) { text += piece; });
  for (const CheckedFile& file : files) reporter.Add(file);
  reporter.End();
  return text;
}

std::string JsonCatalogue() {
  Json json = detail::ReportHead("rules");
  json["rules"] = Json::array();
  for (const Rule& rule : ReadRules()) {
    Json entry{{"id", rule.id},
               {"severity", ToString(rule.severity)},
               {"title", rule.title},
               {"consequence", detail::Concat(kSubject, rule.consequence)}};
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
