// SPDX-License-Identifier: BSD-3-Clause
// In place of what needs Ceres, where it is not there.
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/detail/require_ceres.h"
#include "slamdb/optimize/pose_graph.h"

namespace slamdb {

BundleReport AdjustBundle(Atlas&, MapId, const BundleOptions&) {
  detail::RequireCeres();
  return {};
}
PoseGraphReport OptimizePoseGraph(Atlas&, MapId, const PoseGraphOptions&) {
  detail::RequireCeres();
  return {};
}
bool CanOptimize() { return false; }

}  // namespace slamdb
