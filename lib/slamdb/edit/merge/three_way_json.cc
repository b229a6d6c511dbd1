// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/detail/json.h"
#include "slamdb/edit/merge/detail/report_json.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace detail {
namespace {

Json JsonOf(const BranchLedger& ledger) {
  return {{"base", ledger.base},
          {"ours", ledger.ours},
          {"theirs", ledger.theirs},
          {"added_by_ours", ledger.added_by_ours},
          {"added_by_theirs", ledger.added_by_theirs},
          {"added_by_both", ledger.added_by_both},
          {"deleted_by_ours", ledger.deleted_by_ours},
          {"deleted_by_theirs", ledger.deleted_by_theirs},
          {"deleted_by_both", ledger.deleted_by_both},
          {"kept", ledger.kept},
          {"fused", ledger.fused},
          {"dropped", ledger.dropped},
          {"result", ledger.result}};
}

template <class Entity>
Json IdsJson(const std::vector<Id<Entity>>& ids) {
  Json json = Json::array();
  for (const Id<Entity> id : ids) json.push_back(JsonId(id));
  return json;
}

Json JsonOf(const BranchMotion& motion) {
  return {{"common", motion.common},
          {"carried", motion.carried},
          {"rmse", motion.rms},
          {"max", motion.max},
          {"another_frame", motion.another_frame}};
}

Json JsonOf(const MergedBranchMap& map) {
  Json json = {{"map", JsonId(map.map)},
               {"base", IdsJson(map.base)},
               {"ours", IdsJson(map.ours)},
               {"theirs", IdsJson(map.theirs)},
               {"motion_of_ours", JsonOf(map.motion_of_ours)},
               {"motion_of_theirs", JsonOf(map.motion_of_theirs)},
               {"recounted", map.recounted}};
  if (map.fused) json["fused"] = FuseJson(*map.fused);
  return json;
}

Json JsonOf(const BranchConflict& conflict) {
  Json json = detail::JsonOf(Finding{conflict.place, MessageOf(conflict)});
  json["aspect"] = conflict.what;
  json["taken"] = NameOf(conflict.taken);
  return json;
}

Json SideOrNull(const std::optional<BranchSide>& side) { return side ? Json(NameOf(*side)) : Json(); }

Json BranchesJson(const ThreeWayReport& report) {
  Json json = {{"base", {{"input", report.names[0]}, {"counts", detail::JsonOf(report.counts[0])}}},
               {"geometry", NameOf(report.geometry)},
               {"unchanged", SideOrNull(report.unchanged)},
               {"same", report.same},
               {"contains", SideOrNull(report.contains)}};
  json["ledgers"] = {{"keyframes", JsonOf(report.keyframes)},
                     {"points", JsonOf(report.points)},
                     {"observations", JsonOf(report.observations)},
                     {"edges", JsonOf(report.edges)}};
  json["maps"] = Json::array();
  for (const MergedBranchMap& map : report.maps) json["maps"].push_back(JsonOf(map));
  json["conflicts"] = Json::array();
  for (const BranchConflict& conflict : report.conflicts) json["conflicts"].push_back(JsonOf(conflict));
  json["fused_points"] = Json::array();
  for (const auto& [gone, survivor] : report.fused)
    json["fused_points"].push_back({{"before", JsonId(gone)}, {"after", JsonId(survivor)}});
  json["dropped_points"] = IdsJson(report.dropped_points);
  json["other_images"] = report.other_images;
  json["dangling"] = report.dangling;
  return json;
}

}  // namespace

Json ThreeWayJson(const ThreeWayReport& report, const std::string& output) {
  MergeReport merged;
  for (const std::size_t side : {1, 2})
    merged.inputs.push_back({.name = report.names[side],
                             .counts = report.counts[side],
                             .shift = side == 2 ? report.shift : std::array<std::uint64_t, kIdKinds>(),
                             .cameras = {}});
  merged.dropped_list_entries = report.dropped_list_entries;
  merged.dropped_members = report.dropped_members[0] + report.dropped_members[1];
  merged.warnings = report.warnings;
  merged.result = report.result;
  Json json = MergeJson(merged, output);
  json["branches"] = BranchesJson(report);
  return json;
}

}  // namespace detail

std::string ToJson(const ThreeWayReport& report, const std::string& output) {
  return detail::JsonText(detail::ThreeWayJson(report, output));
}

}  // namespace slamdb
