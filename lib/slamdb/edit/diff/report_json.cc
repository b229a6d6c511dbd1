// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/diff/diff.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const std::vector<EntityName>& names, std::size_t most) {
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
    list.push_back({{"map", detail::JsonId(names[i].map)}, {"id", detail::JsonId(names[i].id)}});
  return list;
}

Json JsonOf(const EntityDiff& diff, std::size_t most) {
  Json aspects = Json::object();
  for (const AspectCount& change : diff.changes) aspects[std::string(change.aspect)] = change.count;
  return {{"before", diff.before},
          {"after", diff.after},
          {"removed", diff.removed.size()},
          {"added", diff.added.size()},
          {"changed", diff.changed},
          {"changed_map", diff.changed_map},
          {"renumbered", diff.renumbered},
          {"aspects", aspects},
          {"removed_ids", JsonOf(diff.removed, most)},
          {"added_ids", JsonOf(diff.added, most)}};
}

Json JsonOf(const LinkDiff& link) {
  return {{"kind", link.kind},       {"before", link.before}, {"after", link.after},
          {"removed", link.removed}, {"added", link.added},   {"changed", link.changed}};
}

Json JsonOf(const MapMotion& motion) {
  return {{"map_before", detail::JsonId(motion.before)},
          {"map_after", detail::JsonId(motion.after)},
          {"keyframes", motion.keyframes},
          {"keyframe_distance", detail::JsonOf(motion.keyframe_distance)},
          {"keyframe_degrees", detail::JsonOf(motion.keyframe_degrees)},
          {"points", motion.points},
          {"point_distance", detail::JsonOf(motion.point_distance)},
          {"after_from_before", motion.after_from_before ? detail::JsonOf(*motion.after_from_before) : Json()},
          {"rest", detail::JsonOf(motion.rest)}};
}

Json JsonOf(const std::vector<FieldDiff>& fields) {
  Json list = Json::array();
  for (const FieldDiff& field : fields)
    list.push_back({{"field", field.field}, {"before", field.before}, {"after", field.after}});
  return list;
}

}  // namespace

std::string_view NameOf(AtlasDiff::Verdict verdict) {
  switch (verdict) {
    case AtlasDiff::Verdict::kSame:
      return "same";
    case AtlasDiff::Verdict::kRenumbered:
      return "renumbered";
    case AtlasDiff::Verdict::kDifferent:
      break;
  }
  return "different";
}

std::string ToJson(const AtlasDiff& diff, const DiffReportOptions& options) {
  Json json = detail::ReportHead("diff");
  json["inputs"] = {{{"input", detail::TextOrNull(options.before)}}, {{"input", detail::TextOrNull(options.after)}}};
  json["verdict"] = NameOf(diff.verdict());
  json["maps"] = JsonOf(diff.maps, options.max_listed);
  json["cameras"] = JsonOf(diff.cameras, options.max_listed);
  json["keyframes"] = JsonOf(diff.keyframes, options.max_listed);
  json["points"] = JsonOf(diff.points, options.max_listed);
  json["links"] = Json::array();
  for (const LinkDiff& link : diff.links) json["links"].push_back(JsonOf(link));
  json["motions"] = Json::array();
  for (const MapMotion& motion : diff.motions)
    if (motion.moved()) json["motions"].push_back(JsonOf(motion));
  json["fields"] = JsonOf(diff.fields);
  json["numbering"] = JsonOf(diff.numbering);
  json["other_ids"] = diff.other_ids;
  json["encoding"] = JsonOf(diff.encoding);
  return detail::JsonText(json);
}

}  // namespace slamdb
