// SPDX-License-Identifier: BSD-3-Clause
// 1. What holds is measured, and a round of least squares run.
// 2. What does not fit then is left out, and a second round run.
// 3. All is judged again; gauge freedoms are taken away, and what was not measured follows.
// 4. What does not fit is erased, and the rest recorded.
#include "slamdb/optimize/bundle_adjustment.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/optimize/detail/bundle.h"
#include "slamdb/optimize/detail/erase_observations.h"
#include "slamdb/optimize/detail/find_map.h"

namespace slamdb {
namespace {

std::vector<std::uint8_t> FreeRows(const Map& map, const BundleOptions& options) {
  std::vector<std::uint8_t> free(map.keyframes.size(), options.keyframes ? 0 : 1);
  if (!options.keyframes) return free;
  for (const std::uint32_t row : detail::RowsOf(map, *options.keyframes)) free[row] = 1;
  return free;
}

void Refine(detail::Bundle& bundle, const BundleOptions& options, BundleReport& report) {
  for (const std::string_view stage : {"adjusting", "adjusting without what does not fit"}) {
    const detail::Solution solution = bundle.Run(options, stage);
    report.iterations += solution.iterations;
    report.converged = solution.converged;
    report.solver = solution.solver;
    if (!bundle.Judge() && solution.converged) break;
  }
  bundle.RestoreGauge();
}

// Returns the points that go.
std::vector<std::uint8_t> Apply(detail::Bundle& bundle, int threads, Map& map, BundleReport& report) {
  const std::vector<const detail::Measurement*> misfits = bundle.Misfits();
  report.dropped = misfits.size();
  std::vector<Similarity3d> motions = detail::MotionsOf(bundle.before(), bundle.states());
  detail::CarryAlong(map, bundle.settled(), motions, bundle.states());
  std::vector<std::uint8_t> culled = detail::EraseObservations(misfits, map);
  detail::Record(bundle.before(), bundle.states(), threads, map);
  return culled;
}

}  // namespace

BundleReport AdjustBundle(Atlas& atlas, MapId id, const BundleOptions& options) {
  if (options.fix_poses && options.fix_points)
    throw Error(ErrorKind::kUsage, "with both poses and points fixed, nothing may move");
  const std::size_t row = detail::FindMap(atlas, id);
  Map& map = atlas.maps[row];
  const AtlasIndex index(atlas);
  detail::Bundle bundle(index, row, FreeRows(map, options), options);
  BundleReport report;
  if (bundle.nothing_moves()) return report;
  Refine(bundle, options, report);
  bundle.Describe(report);
  const std::vector<std::uint8_t> culled = Apply(bundle, options.threads, map, report);
  report.removed_points = static_cast<std::uint64_t>(std::ranges::count(culled, 1));
  if (report.removed_points == 0) return report;
  Subset kept = Subset::Everything(atlas);
  for (std::size_t point = 0; point < culled.size(); ++point)
    if (culled[point]) kept.maps[row].points[point] = 0;
  KeepSubset(atlas, kept, options.threads);
  return report;
}

bool CanOptimize() { return true; }

}  // namespace slamdb
