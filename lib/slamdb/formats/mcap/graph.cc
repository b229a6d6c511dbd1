// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/graph.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "slamdb/formats/export/detail/frusta.h"
#include "slamdb/model/detail/edges.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

GraphLines CamerasOf(const KeyFrameTrajectory& trajectory, const std::vector<Eigen::Vector3f>& centers) {
  GraphLines lines{.name = "cameras", .color = ColorOfMap(trajectory.map->id)};
  const float depth = FrustumDepth(centers);
  for (const TimedPose& pose : trajectory.poses) {
    const auto first = static_cast<std::uint32_t>(lines.points.size());
    for (const Eigen::Vector3f& vertex : FrustumOf(*pose.keyframe, depth).vertices)
      lines.points.push_back(pose.world_from_it * vertex);
    for (const auto& [from, to] : Frustum::kEdges) lines.ends.insert(lines.ends.end(), {first + from, first + to});
  }
  return lines;
}

// Row of a keyframe among the poses; of several with one id the first.
IdTable RowsOf(const KeyFrameTrajectory& trajectory) {
  std::uint64_t lowest = std::numeric_limits<std::uint64_t>::max(), highest = 0;
  for (const TimedPose& pose : trajectory.poses) {
    lowest = std::min(lowest, pose.keyframe->id.value());
    highest = std::max(highest, pose.keyframe->id.value());
  }
  IdTable rows(lowest, highest, trajectory.poses.size());
  for (std::size_t row = 0; row < trajectory.poses.size(); ++row)
    rows.Insert(trajectory.poses[row].keyframe->id.value(), static_cast<std::uint32_t>(row));
  return rows;
}

// The edges that `visit(keyframe, add)` adds of each keyframe.
template <class Visit>
std::vector<std::uint32_t> EdgesOf(const KeyFrameTrajectory& trajectory, const IdTable& rows, Visit visit) {
  RowPairs edges;
  for (std::uint32_t row = 0; row < trajectory.poses.size(); ++row)
    visit(*trajectory.poses[row].keyframe, [&](KeyFrameId other) {
      const std::uint32_t to = other ? rows.Find(other.value()) : kNoRow;
      if (to != kNoRow) edges.push_back(std::minmax(row, to));
    });
  MakeDistinct(edges);
  std::vector<std::uint32_t> ends;
  ends.reserve(2 * edges.size());
  for (const auto& [from, to] : edges) ends.insert(ends.end(), {from, to});
  return ends;
}

// Calls `edge(other)` for every edge that a keyframe records.
template <class Edge>
void ForEachEdge(const KeyFrame& keyframe, Edge edge) {
  for (const Connection& connection : keyframe.connections) edge(connection.keyframe);
  edge(keyframe.parent);
  for (const auto* list : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges})
    for (const KeyFrameId other : *list) edge(other);
}

}  // namespace

std::size_t CountEdgesOutside(const KeyFrameTrajectory& trajectory) {
  if (trajectory.poses.empty()) return 0;
  const IdTable rows = RowsOf(trajectory);
  std::set<std::pair<KeyFrameId, KeyFrameId>> outside;
  for (const TimedPose& pose : trajectory.poses)
    ForEachEdge(*pose.keyframe, [&](KeyFrameId other) {
      if (other && rows.Find(other.value()) == kNoRow) outside.emplace(pose.keyframe->id, other);
    });
  return outside.size();
}

std::vector<GraphLines> GraphOf(const KeyFrameTrajectory& trajectory) {
  if (trajectory.poses.empty()) return {};
  const std::vector<Eigen::Vector3f> centers = CentersOf(trajectory);
  const IdTable rows = RowsOf(trajectory);
  std::vector<GraphLines> all = {CamerasOf(trajectory, centers)};
  const auto add = [&](std::string_view name, const Color& color, double opacity, std::vector<std::uint32_t> ends) {
    if (!ends.empty()) all.push_back({name, color, opacity, centers, std::move(ends)});
  };
  std::vector<std::uint32_t> path;
  for (std::uint32_t row = 1; row < centers.size(); ++row) path.insert(path.end(), {row - 1, row});
  add("trajectory", ColorOfMap(trajectory.map->id), 1, std::move(path));
  add("covisibility", kCovisibilityColor, 0.3, EdgesOf(trajectory, rows, [](const KeyFrame& keyframe, auto edge) {
        for (const Connection& connection : keyframe.connections) edge(connection.keyframe);
      }));
  add("spanning tree", kSpanningTreeColor, 1,
      EdgesOf(trajectory, rows, [](const KeyFrame& keyframe, auto edge) { edge(keyframe.parent); }));
  add("loops", kLoopColor, 1, EdgesOf(trajectory, rows, [](const KeyFrame& keyframe, auto edge) {
        for (const KeyFrameId other : keyframe.loop_edges) edge(other);
      }));
  add("merges", kMergeColor, 1, EdgesOf(trajectory, rows, [](const KeyFrame& keyframe, auto edge) {
        for (const KeyFrameId other : keyframe.merge_edges) edge(other);
      }));
  return all;
}

}  // namespace slamdb::detail
