// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/warnings.h"

#include "slamdb/base/error.h"

namespace slamdb {
namespace {

bool IsHalfOpen(const PoseGraphReport& graph) {
  const auto open = [](double before, double after, double least) { return before > least && 2 * after > before; };
  return open(graph.gap_before.translation, graph.gap_after.translation, 1e-3) ||
         open(graph.gap_before.degrees, graph.gap_after.degrees, 0.5) ||
         open(graph.gap_before.scale, graph.gap_after.scale, 0.01);
}

}  // namespace

OptimizeMethod UsualMethod(const std::vector<PoseConstraint>& constraints) {
  return constraints.empty() ? OptimizeMethod::kFull : OptimizeMethod::kPoseGraph;
}

void RequireOptimized(const OptimizeReport& report) {
  for (const MapOptimization& map : report.maps)
    if (map.bundle || map.pose_graph) return;
  throw Error(ErrorKind::kNotPossible,
              report.method == OptimizeMethod::kSeam
                  ? "has no seam: no merge or loop edge; OptimizeMethod::kFull adjusts all of it"
                  : "has nothing to optimise");
}

void TellWarnings(const MapOptimization& map, const std::string& remedy, Notices& notices) {
  const std::string name = ToString(map.map) + ": ";
  if (map.pose_graph && !map.pose_graph->converged) notices.Warn(name + "the pose graph has not settled; " + remedy);
  if (map.pose_graph && IsHalfOpen(*map.pose_graph))
    notices.Warn(name + "the constraints are met by less than half; the map's own edges hold it back");
  if (!map.bundle) return;
  for (const std::string& warning : map.bundle->warnings) notices.Warn(name + warning);
  if (map.bundle->iterations > 0 && !map.bundle->converged)
    notices.Warn(name + "bundle adjustment has not settled; " + remedy);
}

}  // namespace slamdb
