// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/many/add.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const AddedAtlas& atlas) {
  Json json = {{"input", atlas.input}, {"name", atlas.name}, {"result", NameOf(atlas.result)}};
  if (atlas.result == AddResult::kNotTried) {
    json["result"] = "not-tried";
    return json;
  }
  if (atlas.result == AddResult::kFailed) {
    json["failure"] = atlas.failure;
    return json;
  }
  json["maps"] = atlas.summary.maps;
  json["keyframes"] = atlas.summary.keyframes;
  json["points"] = atlas.summary.points;
  json["landmarks"] = atlas.summary.landmarks;
  json["hash"] = detail::Hex(atlas.hash);
  return json;
}

}  // namespace

std::string_view NameOf(AddResult result) {
  constexpr std::array<std::string_view, 5> kNames = {"added", "replaced", "unchanged", "failed", "not tried"};
  return kNames.at(static_cast<std::size_t>(result));
}

std::string ToJson(const AddReport& report) {
  Json json = detail::ReportHead("add");
  json["output"] = report.dry_run ? Json() : Json(report.store);
  json["inputs"] = Json::array();
  for (const AddedAtlas& atlas : report.atlases) json["inputs"].push_back(JsonOf(atlas));
  for (const AddResult result : {AddResult::kAdded, AddResult::kReplaced, AddResult::kUnchanged, AddResult::kFailed})
    json[std::string(NameOf(result))] = report.Count(result);
  json["not_tried"] = report.Count(AddResult::kNotTried);
  json["atlases"] = report.in_store;
  return detail::JsonText(json);
}

}  // namespace slamdb
