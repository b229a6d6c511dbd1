// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/report_json.h"

#include <algorithm>

#include "slamdb/edit/merge/merge.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace detail {
namespace {

Json JsonOf(const MergedInput& input) {
  Json shift, cameras = Json::array();
  for (std::size_t kind = 0; kind < kIdKinds; ++kind)
    if (const auto as_kind = static_cast<IdKind>(kind); as_kind != IdKind::kCamera)
      shift[std::string(NameOf(as_kind))] = static_cast<std::int64_t>(input.shift[kind]);
  for (const IdPair& camera : input.cameras)
    cameras.push_back({{"before", JsonId(camera.before)}, {"after", JsonId(camera.after)}});
  return {{"input", input.name}, {"counts", detail::JsonOf(input.counts)}, {"shift", shift}, {"cameras", cameras}};
}

Json JsonOf(const AnchorFit& fit) {
  Json anchors = Json::array();
  for (std::size_t i = 0; i < fit.residuals.size(); ++i)
    anchors.push_back({{"residual", fit.residuals[i]}, {"inlier", fit.inliers[i] != 0}});
  return {{"pairs", fit.residuals.size()},
          {"inliers", std::ranges::count(fit.inliers, 1)},
          {"residuals", {{"rmse", fit.rms}, {"max", fit.max}}},
          {"anchors", anchors}};
}

}  // namespace

Json FuseJson(const FuseReport& fused) {
  return {{"candidates", fused.candidates},       {"points", fused.fused},
          {"seen_together", fused.seen_together}, {"observations", fused.observations},
          {"cleared_slots", fused.cleared_slots}, {"keyframes", fused.keyframes},
          {"mean_distance", fused.mean_distance}};
}

Json JoinJson(const JoinReport& join) {
  Json json = {
      {"map", JsonId(join.first)},
      {"first_from_second", detail::JsonOf(join.first_from_second)},
      {"link",
       {{"first", JsonId(join.link.first)}, {"second", JsonId(join.link.second)}, {"distance", join.link_distance}}},
      {"keyframes", join.keyframes},
      {"points", join.points},
      {"left_inertial", join.left_inertial},
      {"warnings", join.warnings}};
  if (join.fit) json["alignment"] = JsonOf(*join.fit);
  if (join.fused) json["fused"] = FuseJson(*join.fused);
  json["landmarks"] = join.landmarks;
  json["fused_landmarks"] = join.fused_landmarks;
  if (join.alike)
    json["alike_landmarks"] = {{"fused", join.alike->fused},
                               {"plain", join.alike->plain},
                               {"unplaced", join.alike->unplaced},
                               {"mean_distance", join.alike->mean_distance}};
  return json;
}

Json MergeJson(const MergeReport& report, const std::string& output) {
  Json json = ReportHead("merge");
  json["inputs"] = Json::array();
  for (const MergedInput& input : report.inputs) json["inputs"].push_back(JsonOf(input));
  json["output"] = TextOrNull(output);
  json["same_maps"] = Json::array();
  for (const MapTwice& twice : report.same_maps)
    json["same_maps"].push_back({{"input", report.inputs[twice.input].name},
                                 {"map", JsonId(twice.map)},
                                 {"first_input", report.inputs[twice.first_input].name},
                                 {"first_map", JsonId(twice.first_map)},
                                 {"left_out", twice.left_out}});
  json["dropped_list_entries"] = report.dropped_list_entries;
  json["other_vocabularies"] = report.other_vocabularies;
  json["other_layouts"] = report.other_layouts;
  json["dropped_members"] = report.dropped_members;
  json["warnings"] = report.warnings;
  json["left_out"] = detail::JsonOf(report.left_out);
  json["result"] = detail::JsonOf(report.result);
  if (report.join) json["join"] = JoinJson(*report.join);
  return json;
}

}  // namespace detail

std::string ToJson(const MergeReport& report, const std::string& output) {
  return detail::JsonText(detail::MergeJson(report, output));
}

}  // namespace slamdb
