// SPDX-License-Identifier: BSD-3-Clause
// 1. Loops are found in every map, before any is changed.
// 2. Of each missed one a few pairs of keyframes are constraints, by which the map is bent.
// 3. They become loop edges, and points of both ends are fused.
// 4. The bundle is adjusted.
#include "slamdb/align/close_loops.h"

#include <algorithm>
#include <utility>

#include "slamdb/align/detail/strongest_pairs.h"
#include "slamdb/model/detail/irregular_entries.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/detail/find_map.h"
#include "slamdb/optimize/detail/require_ceres.h"

namespace slamdb {
namespace {

bool HasViews(const Map& map) {
  return std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) { return !keyframe.bad; }) &&
         std::ranges::any_of(map.points, [](const MapPoint& point) { return !point.bad && point.has_descriptor(); });
}

// Rows of the atlas.
std::vector<std::size_t> MapsOf(const Atlas& atlas, const CloseLoopsOptions& options) {
  std::vector<std::size_t> rows;
  for (const MapId id : options.maps) (void)detail::FindMap(atlas, id);
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    const bool wanted = options.maps.empty() || std::ranges::find(options.maps, map.id) != options.maps.end();
    if (wanted && HasViews(map)) rows.push_back(row);
  }
  return rows;
}

void AddLoopEdge(Map& map, const IdTable& rows, KeyFrameId from, KeyFrameId to) {
  const std::uint32_t row = rows.Find(from.value());
  if (row == kNoRow) return;
  KeyFrame& keyframe = map.keyframes[row];
  keyframe.not_erase = true;
  if (std::ranges::find(keyframe.loop_edges, to) == keyframe.loop_edges.end()) keyframe.loop_edges.push_back(to);
}

void Close(Atlas& atlas, std::size_t row, const CloseLoopsOptions& options, ClosedMap& closed) {
  std::vector<AlignedPair> pairs;
  std::vector<MatchedPoints> same;
  for (const Loop& loop : closed.search.loops) {
    if (loop.verdict != LoopVerdict::kMissed) continue;
    std::ranges::move(detail::StrongestPairs(loop.pairs), std::back_inserter(pairs));
    same.insert(same.end(), loop.matches.begin(), loop.matches.end());
  }
  detail::DropIrregularEntries(atlas);  // they name rows of lists that change
  PoseGraphOptions graph;
  graph.threads = options.threads;
  graph.progress = options.progress;
  for (const AlignedPair& pair : pairs)
    graph.constraints.push_back(
        {.first = pair.first, .second = pair.second, .first_from_second = pair.first_from_second});
  closed.constraints = pairs.size();
  closed.optimization.pose_graph = OptimizePoseGraph(atlas, closed.map, graph);
  Map& map = atlas.maps[row];
  const IdTable rows = KeyFrameTable(map);
  for (const AlignedPair& pair : pairs) {
    AddLoopEdge(map, rows, pair.first, pair.second);
    AddLoopEdge(map, rows, pair.second, pair.first);
  }
  closed.fused = FusePairs(map, detail::SurestFirst(std::move(same)));
  ++map.big_change_index;
  if (!options.adjust_bundle) return;
  BundleOptions bundle;
  bundle.threads = options.threads;
  bundle.progress = options.progress;
  closed.optimization.bundle = AdjustBundle(atlas, closed.map, bundle);
}

// Why what closing made of a map must not be; empty: it may.
std::string BrokenBy(const MapOptimization& optimization) {
  constexpr double kLeftOpen = 0.5, kMostDropped = 0.15;
  const PoseGraphReport& graph = *optimization.pose_graph;
  if (graph.gap_after.translation > kLeftOpen * graph.gap_before.translation &&
      graph.gap_after.degrees > kLeftOpen * graph.gap_before.degrees)
    return "the map cannot be bent to close it";
  if (!optimization.bundle) return {};
  const BundleReport& bundle = *optimization.bundle;
  if (static_cast<double>(bundle.dropped) > kMostDropped * static_cast<double>(bundle.observations + bundle.dropped))
    return "closing it makes " + std::to_string(bundle.dropped) + " observations misfit";
  return {};
}

// In place, or not at all.
void CloseIfSound(Atlas& atlas, std::size_t row, const CloseLoopsOptions& options, ClosedMap& closed) {
  Atlas before = atlas;
  Close(atlas, row, options, closed);
  const std::string broken = BrokenBy(closed.optimization);
  if (broken.empty()) return;
  atlas = std::move(before);
  closed = {.map = closed.map, .search = std::move(closed.search), .fused = {}, .optimization = {.map = closed.map}};
  for (Loop& loop : closed.search.loops) {
    if (loop.verdict != LoopVerdict::kMissed) continue;
    loop.verdict = LoopVerdict::kDoubtful;
    loop.reason = broken;
  }
}

std::uint64_t MissedIn(const ClosedMap& map) {
  return static_cast<std::uint64_t>(std::ranges::count(map.search.loops, LoopVerdict::kMissed, &Loop::verdict));
}

}  // namespace

CloseLoopsReport CloseLoops(Atlas& atlas, const CloseLoopsOptions& options) {
  CloseLoopsReport report;
  const std::vector<std::size_t> rows = MapsOf(atlas, options);
  for (const std::size_t row : rows) {
    ClosedMap& closed = report.maps.emplace_back();
    closed.map = closed.optimization.map = atlas.maps[row].id;
    closed.search =
        FindLoops({&atlas, row},
                  {.own_vocabulary = options.own_vocabulary, .threads = options.threads, .progress = options.progress});
    report.closed += MissedIn(closed);
  }
  if (report.closed > 0) detail::RequireCeres();
  report.closed = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (MissedIn(report.maps[i]) > 0) CloseIfSound(atlas, rows[i], options, report.maps[i]);
    report.closed += MissedIn(report.maps[i]);
  }
  return report;
}

}  // namespace slamdb
