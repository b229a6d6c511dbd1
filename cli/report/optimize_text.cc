// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/optimize_text.h"

#include <cmath>

#include "cli/report/layout.h"

namespace slamdb::cli {
namespace {

std::string HeldText(Gauge gauge) {
  switch (gauge) {
    case Gauge::kKeyFrame:
      return "the initial keyframe";
    case Gauge::kKeyFrameAndScale:
      return "the initial keyframe, and the scale";
    case Gauge::kHeading:
      return "place and heading of the initial keyframe; gravity gives the rest";
    case Gauge::kNeighbours:
      return "the keyframes around";
    case Gauge::kPoints:
      return "the points";
  }
  return {};
}

std::string ChangeText(double before, double after) { return Short(before) + " -> " + Short(after); }

std::string StepsText(int iterations, bool converged) {
  return Counted(static_cast<std::uint64_t>(iterations), "step") + (converged ? "" : ", not settled");
}

using Rows = std::vector<std::pair<std::string, std::string>>;

void AddGraph(const PoseGraphReport& graph, Rows& rows) {
  const std::uint64_t edges = graph.constraints + graph.tree_edges + graph.loop_edges + graph.merge_edges +
                              graph.inertial_edges + graph.covisibility_edges;
  rows.emplace_back("pose graph", Counted(graph.keyframes, "keyframe") + ", " + Counted(edges, "edge") + ", " +
                                      Counted(graph.constraints, "constraint") + "; " +
                                      std::string(NameOf(graph.freedom)) + "; " +
                                      StepsText(graph.iterations, graph.converged));
  std::string gap = ChangeText(graph.gap_before.translation, graph.gap_after.translation) + ", " +
                    ChangeText(graph.gap_before.degrees, graph.gap_after.degrees) + " degrees";
  if (graph.freedom == PoseFreedom::kSimilarity)
    gap += ", scale " + ChangeText(graph.gap_before.scale, graph.gap_after.scale) + " (log)";
  rows.emplace_back("gaps", gap + "; rms of the constraints");
  rows.emplace_back("moved", "cameras by up to " + Short(graph.largest_shift));
}

void AddBundle(const BundleReport& bundle, Rows& rows) {
  std::string what = Counted(bundle.keyframes, "keyframe") + " and " + Counted(bundle.points, "point");
  if (bundle.fixed_keyframes > 0) what += "; " + Counted(bundle.fixed_keyframes, "keyframe") + " fixed";
  rows.emplace_back("adjusted", what);
  rows.emplace_back("held by", HeldText(bundle.gauge));
  std::string used = Grouped(bundle.observations);
  if (bundle.with_depth > 0) used += ", " + Grouped(bundle.with_depth) + " with depth";
  if (bundle.inertial_links > 0) used += "; " + Counted(bundle.inertial_links, "inertial link");
  rows.emplace_back("observations", used);
  rows.emplace_back("dropped", Counted(bundle.dropped, "observation") + " (" +
                                   Percent(bundle.dropped, bundle.observations) + "), " +
                                   Counted(bundle.removed_points, "point"));
  rows.emplace_back("reprojection", ChangeText(bundle.error_before.mean, bundle.error_after.mean) + " px on average, " +
                                        "median " + ChangeText(bundle.error_before.median, bundle.error_after.median));
  const auto whole = [](double cost) { return Grouped(static_cast<std::uint64_t>(std::llround(cost))); };
  rows.emplace_back("cost", whole(bundle.cost_before) + " -> " + whole(bundle.cost_after) + "; " +
                                StepsText(bundle.iterations, bundle.converged) + ", " + bundle.solver);
}

}  // namespace

std::string OptimizeText(const OptimizeReport& report) {
  std::string text;
  for (const MapOptimization& map : report.maps) {
    Rows rows;
    if (map.pose_graph) AddGraph(*map.pose_graph, rows);
    if (map.bundle && map.bundle->observations > 0) AddBundle(*map.bundle, rows);
    text += ToString(map.map) + "\n";
    if (rows.empty()) text += "  nothing to optimise\n";
    Table table({Table::Align::kLeft, Table::Align::kLeft}, 2);
    for (const auto& [name, value] : rows) table.Add({name, value});
    text += table.ToString();
  }
  return text;
}

}  // namespace slamdb::cli
