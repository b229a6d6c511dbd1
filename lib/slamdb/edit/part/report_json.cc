// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/cull.h"
#include "slamdb/edit/part/detail/removed_json.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/fragments.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const EntityCounts& counts) {
  return {{"maps", counts.maps},
          {"keyframes", counts.keyframes},
          {"points", counts.points},
          {"landmarks", counts.landmarks}};
}

Json JsonOf(const Coverage& coverage) {
  return {{"min_points", coverage.min_points},
          {"places", coverage.places},
          {"covered_before", coverage.covered_before},
          {"covered", coverage.covered}};
}

Json JsonOf(const Fragment& map) {
  return {{"id", detail::JsonId(map.id)}, {"keyframes", map.keyframes}, {"points", map.points},
          {"begin_time", map.begin_time}, {"end_time", map.end_time},   {"kept", map.kept}};
}

}  // namespace

void detail::AddRemoved(const SubsetReport& removed, Json& json) {
  json["before"] = slamdb::JsonOf(removed.before);
  json["after"] = slamdb::JsonOf(removed.after);
  json["cut"] = {{"observations", removed.observations},
                 {"slots", removed.slots},
                 {"edges", removed.edges},
                 {"cameras", removed.cameras}};
  json["chosen"] = {{"references", removed.new_references},
                    {"parents", removed.new_parents},
                    {"joined_preintegrations", removed.joined}};
}

std::string ToJson(const SubsetReport& report) {
  Json json;
  detail::AddRemoved(report, json);
  return detail::JsonText(json);
}

std::string ToJson(const ExtractReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("extract", files);
  detail::AddRemoved(report.removed, json);
  json["coverage"] = JsonOf(report.coverage);
  return detail::JsonText(json);
}

std::string ToJson(const CullReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("cull", files);
  json["culled"] = {{"redundant_keyframes", report.redundant_keyframes},
                    {"points",
                     {{"bad", report.bad_points},
                      {"few_observations", report.few_observations},
                      {"large_error", report.large_errors},
                      {"small_parallax", report.small_parallax},
                      {"unseen", report.unseen},
                      {"unheld", report.unheld}}}};
  detail::AddRemoved(report.removed, json);
  json["coverage"] = JsonOf(report.coverage);
  return detail::JsonText(json);
}

std::string ToJson(const ShrinkReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("shrink", files);
  detail::AddRemoved(report.removed, json);
  json["coverage"] = JsonOf(report.coverage);
  json["bytes"] = {{"before", report.bytes_before}, {"after", report.bytes_after}};
  json["dropped"] = {{"features", report.features_dropped}, {"imu_measurements", report.measurements_dropped}};
  json["found"] = nullptr;
  if (report.found)
    json["found"] = {
        {"places", report.found->places}, {"before", report.found->before}, {"after", report.found->after}};
  return detail::JsonText(json);
}

std::string ToJson(const FragmentReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("fragments", files);
  json["maps"] = Json::array();
  for (const Fragment& map : report.maps) json["maps"].push_back(JsonOf(map));
  detail::AddRemoved(report.removed, json);
  json["order"] = Json::array();
  for (const MapId id : report.order) json["order"].push_back(detail::JsonId(id));
  return detail::JsonText(json);
}

std::string ToJson(std::span<const TakenPart> parts, const ReportFiles& files) {
  Json json = detail::ReportHead("split", files.input);
  json["parts"] = Json::array();
  for (const TakenPart& part : parts) {
    Json entry = {{"name", part.name}, {"output", detail::TextOrNull(part.output)}};
    entry.update(JsonOf(part.counts));
    json["parts"].push_back(std::move(entry));
  }
  return detail::JsonText(json);
}

}  // namespace slamdb
