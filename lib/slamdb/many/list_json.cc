// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json_list.h"
#include "slamdb/formats/info.h"
#include "slamdb/many/list.h"

namespace slamdb {
namespace {

using detail::Json;
using detail::NumberOrNull;

void AddSummary(const AtlasSummary& summary, Json& json) {
  json["maps"] = summary.maps;
  json["sensors"] = Json::array();
  for (const MapSensor sensor : summary.sensors) json["sensors"].push_back(NameOf(sensor));
  json["imu"] = summary.has_imu;
  json["metric"] = summary.is_metric;
  json["keyframes"] = summary.keyframes;
  json["points"] = summary.points;
  json["landmarks"] = summary.landmarks;
  json["observations"] = summary.observations;
  json["trajectory_length"] = summary.trajectory_length;
  json["begin_time"] = NumberOrNull(summary.begin_time);
  json["end_time"] = NumberOrNull(summary.end_time);
  json["duration_s"] = summary.duration;
}

Json JsonOf(const ListedAtlas& atlas) {
  Json json = {{"input", atlas.input},
               {"name", atlas.name},
               {"format", detail::TextOrNull(atlas.format)},
               {"bytes", NumberOrNull(atlas.bytes)},
               {"saved_at", detail::TextOrNull(atlas.saved_at)}};
  if (!atlas.failure.empty()) {
    json["failure"] = atlas.failure;
    return json;
  }
  AddSummary(atlas.summary, json);
  if (atlas.revision > 0) json["revision"] = atlas.revision;
  if (atlas.hash) json["hash"] = detail::Hex(*atlas.hash);
  if (!atlas.findings) return json;
  json["sound"] = atlas.ok();
  json["severities"] = {
      {"error", atlas.findings->errors}, {"warning", atlas.findings->warnings}, {"note", atlas.findings->notes}};
  return json;
}

}  // namespace

std::string ToJson(std::span<const ListedAtlas> atlases, const std::string& input) {
  std::string text;
  WriteJson(atlases, input, [&](std::string_view piece) { text += piece; });
  return text;
}

void WriteJson(std::span<const ListedAtlas> atlases, const std::string& input,
               const std::function<void(std::string_view text)>& sink) {
  detail::JsonListWriter list(detail::ReportHead("list", input), "atlases", sink);
  for (const ListedAtlas& atlas : atlases) list.Add(JsonOf(atlas));
  list.End();
}

std::string ToJson(const AtlasSummary& summary) {
  Json json = Json::object();
  AddSummary(summary, json);
  return detail::JsonText(json);
}

}  // namespace slamdb
