// SPDX-License-Identifier: BSD-3-Clause
// In place of what needs Ceres, where it is not there.
#include "slamdb/base/error.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/pose_graph.h"

namespace slamdb {
namespace {

[[noreturn]] void Refuse() {
  throw Error(ErrorKind::kUnsupported,
              "this slamdb was built without Ceres, which optimises: install libceres-dev and build it again");
}

}  // namespace

BundleReport AdjustBundle(Atlas&, MapId, const BundleOptions&) { Refuse(); }
PoseGraphReport OptimizePoseGraph(Atlas&, MapId, const PoseGraphOptions&) { Refuse(); }
bool CanOptimize() { return false; }

}  // namespace slamdb
