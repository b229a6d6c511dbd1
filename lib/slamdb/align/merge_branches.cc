// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/merge_branches.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "slamdb/align/detail/find_across.h"
#include "slamdb/align/detail/follow_tightening.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/observe.h"
#include "slamdb/optimize/detail/require_ceres.h"

namespace slamdb {
namespace {

constexpr int kRounds = 2;

// By id: which side took a keyframe; both have what is not new.
class Sides {
 public:
  explicit Sides(const std::vector<IdMap>& ids) {
    for (std::size_t side = 0; side < ids.size(); ++side)
      for (const IdPair& pair : ids[side][IdKind::kKeyFrame]) has_[side].insert(pair.after);
  }

  std::uint32_t Of(KeyFrameId id) const {
    const bool ours = has_[0].contains(id.value()), theirs = has_[1].contains(id.value());
    return ours == theirs ? 0 : ours ? 1 : 2;
  }

 private:
  std::unordered_set<std::uint64_t> has_[2];
};

std::size_t RowOf(const Atlas& atlas, MapId id) {
  return static_cast<std::size_t>(std::ranges::find(atlas.maps, id, &Map::id) - atlas.maps.begin());
}

OptimizedJoin Tighten(Atlas& atlas, MapId id, const Sides& sides, const ThreeWayOptions& options) {
  OptimizedJoin round;
  Map& map = atlas.maps[RowOf(atlas, id)];
  std::vector<std::uint32_t> sessions;
  for (const KeyFrame& keyframe : map.keyframes) sessions.push_back(sides.Of(keyframe.id));
  detail::Across across;
  {
    const detail::MapViews views(atlas, RowOf(atlas, id), options.threads);
    across = detail::FindAcross(views, sessions, options.threads);
  }
  round.observations = AddObservations(map, across.seen);
  round.fused = FusePairs(map, std::move(across.same));
  if (options.progress) options.progress("welding", 1);
  round.optimization =
      OptimizeMaps(
          atlas,
          {.method = OptimizeMethod::kFull, .maps = {id}, .threads = options.threads, .progress = options.progress})
          .maps.front();
  return round;
}

}  // namespace

MergeBranchesResult MergeBranches(Atlas base, Atlas ours, Atlas theirs, const ThreeWayOptions& options) {
  const bool optimizes = options.geometry == BranchGeometry::kOptimize;
  if (optimizes) detail::RequireCeres();
  ThreeWayOptions merge = options;
  merge.id_maps = options.id_maps || optimizes;
  MergeBranchesResult result{.merged = MergeThreeWays(std::move(base), std::move(ours), std::move(theirs), merge),
                             .tightened = {}};
  Atlas& atlas = result.merged.atlas;
  ThreeWayReport& report = result.merged.report;
  if (optimizes) {
    const std::vector<MapPointId> before = detail::SortedPoints(atlas);
    const Sides sides(report.id_maps);
    for (const MergedBranchMap& map : report.maps)
      for (int round = 0; round < kRounds; ++round) result.tightened.push_back(Tighten(atlas, map.map, sides, options));
    detail::FollowTightening(result.tightened, before, atlas, report.id_maps);
  }
  if (!options.id_maps) report.id_maps.clear();
  return result;
}

}  // namespace slamdb
