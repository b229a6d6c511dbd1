// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/report_json.h"

#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const PoseGraphReport::Gap& gap) {
  return {{"translation", gap.translation}, {"rotation_degrees", gap.degrees}, {"log_scale", gap.scale}};
}

Json JsonOf(const PoseGraphReport& graph) {
  return {{"freedom", NameOf(graph.freedom)},
          {"keyframes", graph.keyframes},
          {"edges",
           {{"constraints", graph.constraints},
            {"tree", graph.tree_edges},
            {"loop", graph.loop_edges},
            {"merge", graph.merge_edges},
            {"inertial", graph.inertial_edges},
            {"covisibility", graph.covisibility_edges}}},
          {"before", {{"cost", graph.cost_before}, {"gap", JsonOf(graph.gap_before)}}},
          {"after", {{"cost", graph.cost_after}, {"gap", JsonOf(graph.gap_after)}}},
          {"largest_shift", graph.largest_shift},
          {"iterations", graph.iterations},
          {"converged", graph.converged}};
}

Json JsonOf(double cost, const Distribution& error) {
  return {{"cost", cost}, {"reprojection_error_px", detail::JsonOf(error)}};
}

Json JsonOf(const BundleReport& bundle) {
  return {{"keyframes", bundle.keyframes},
          {"fixed_keyframes", bundle.fixed_keyframes},
          {"points", bundle.points},
          {"held_by", NameOf(bundle.gauge)},
          {"observations", bundle.observations},
          {"with_depth", bundle.with_depth},
          {"inertial_links", bundle.inertial_links},
          {"dropped_observations", bundle.dropped},
          {"removed_points", bundle.removed_points},
          {"before", JsonOf(bundle.cost_before, bundle.error_before)},
          {"after", JsonOf(bundle.cost_after, bundle.error_after)},
          {"iterations", bundle.iterations},
          {"converged", bundle.converged},
          {"solver", bundle.solver},
          {"warnings", bundle.warnings}};
}

}  // namespace

detail::Json detail::OptimizationJson(const MapOptimization& optimization) {
  return {{"map", JsonId(optimization.map)},
          {"pose_graph", optimization.pose_graph ? slamdb::JsonOf(*optimization.pose_graph) : Json()},
          {"bundle", optimization.bundle ? slamdb::JsonOf(*optimization.bundle) : Json()}};
}

std::string ToJson(const OptimizeReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("optimize", files);
  json["method"] = NameOf(report.method);
  json["maps"] = Json::array();
  for (const MapOptimization& map : report.maps) json["maps"].push_back(detail::OptimizationJson(map));
  return detail::JsonText(json);
}

}  // namespace slamdb
