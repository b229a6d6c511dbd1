// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/optimize.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/detail/find_map.h"
#include "slamdb/optimize/detail/require_ceres.h"

namespace slamdb {
namespace {

constexpr int kUsualIterations = 50;

std::vector<MapId> MapsOf(const Atlas& atlas, const OptimizeOptions& options) {
  for (const MapId id : options.maps) static_cast<void>(detail::FindMap(atlas, id));
  std::vector<MapId> maps;
  for (const Map& map : atlas.maps)
    if (options.maps.empty() ? !map.keyframes.empty() : std::ranges::count(options.maps, map.id) > 0)
      maps.push_back(map.id);
  return maps;
}

// By map, those between two of its keyframes.
std::vector<std::vector<PoseConstraint>> Sorted(const Atlas& atlas, const std::vector<MapId>& maps,
                                                const OptimizeOptions& options) {
  std::vector<IdTable> tables;
  for (const MapId map : maps) tables.push_back(KeyFrameTable(atlas.maps[detail::FindMap(atlas, map)]));
  std::vector<std::vector<PoseConstraint>> sorted(maps.size());
  for (const PoseConstraint& constraint : options.constraints) {
    const auto holds = [&](const IdTable& table) {
      return table.Find(constraint.first.value()) != kNoRow && table.Find(constraint.second.value()) != kNoRow;
    };
    const auto found = std::ranges::find_if(tables, holds);
    if (found == tables.end())
      throw Error(ErrorKind::kNotFound, "a constraint is between " + ToString(constraint.first) + " and " +
                                            ToString(constraint.second) +
                                            ", which no map that is optimised has both of");
    sorted[static_cast<std::size_t>(found - tables.begin())].push_back(constraint);
  }
  return sorted;
}

void RequireSense(const OptimizeOptions& options) {
  detail::RequireCeres();
  if (options.fix_poses && options.fix_points)
    throw Error(ErrorKind::kUsage, "with both poses and points fixed, nothing may move");
  if (options.iterations && *options.iterations < 1)
    throw Error(ErrorKind::kUsage, "the number of iterations must be above 0");
  if (options.method != OptimizeMethod::kPoseGraph) return;
  if (options.constraints.empty())
    throw Error(ErrorKind::kUsage,
                "a pose graph is bent by constraints alone, and there is none: give some, or adjust "
                "the bundle");
  if (options.fix_poses || options.fix_points)
    throw Error(ErrorKind::kUsage, "a pose graph moves poses, and points with them: fix neither");
}

// None where there is no seam.
std::optional<BundleReport> Adjust(Atlas& atlas, MapId map, const OptimizeOptions& options) {
  BundleOptions bundle{.fix_poses = options.fix_poses,
                       .fix_points = options.fix_points,
                       .iterations = options.iterations.value_or(kUsualIterations),
                       .threads = options.threads,
                       .progress = options.progress};
  if (options.method == OptimizeMethod::kSeam) {
    const Map& seen = atlas.maps[detail::FindMap(atlas, map)];
    const IdTable rows = KeyFrameTable(seen);
    std::vector<KeyFrameId> around = options.seam;
    std::erase_if(around, [&](KeyFrameId id) { return rows.Find(id.value()) == kNoRow; });
    if (around.empty() && !options.seam.empty()) return std::nullopt;
    bundle.keyframes = SeamKeyFrames(seen, around);
    if (bundle.keyframes->empty()) return std::nullopt;
  }
  return AdjustBundle(atlas, map, bundle);
}

}  // namespace

std::string_view NameOf(OptimizeMethod method) {
  switch (method) {
    case OptimizeMethod::kPoseGraph:
      return "pose-graph";
    case OptimizeMethod::kSeam:
      return "seam";
    case OptimizeMethod::kFull:
      return "full";
  }
  return "?";
}

OptimizeReport OptimizeMaps(Atlas& atlas, const OptimizeOptions& options) {
  RequireSense(options);
  OptimizeReport report{.method = options.method};
  const std::vector<MapId> maps = MapsOf(atlas, options);
  const std::vector<std::vector<PoseConstraint>> constraints = Sorted(atlas, maps, options);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    MapOptimization& map = report.maps.emplace_back(MapOptimization{.map = maps[i]});
    if (!constraints[i].empty())
      map.pose_graph = OptimizePoseGraph(atlas, maps[i],
                                         {.constraints = constraints[i],
                                          .iterations = options.iterations.value_or(kUsualIterations),
                                          .threads = options.threads,
                                          .progress = options.progress});
    if (options.method != OptimizeMethod::kPoseGraph) map.bundle = Adjust(atlas, maps[i], options);
  }
  return report;
}

}  // namespace slamdb
