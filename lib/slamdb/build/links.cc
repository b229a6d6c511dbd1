// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/links.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "slamdb/build/detail/columns.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/edges.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::RefuseRow;

std::uint32_t RowOf(const IdTable& table, std::string_view column, std::size_t row, KeyFrameId id) {
  const std::uint32_t found = table.Find(id.value());
  if (found == kNoRow) RefuseRow(column, row, "names keyframe ", id.value(), ", which the map does not have");
  return found;
}

// Parents by row, kNoRow for roots; of a tree that is not sound, too.
std::vector<std::uint32_t> ParentsOf(const Map& map, const IdTable& table) {
  std::vector<std::uint32_t> parents;
  for (const KeyFrame& keyframe : map.keyframes)
    parents.push_back(keyframe.parent ? table.Find(keyframe.parent.value()) : kNoRow);
  return parents;
}

bool IsOnCycle(const std::vector<std::uint32_t>& parents, std::uint32_t row) {
  std::uint32_t at = parents[row];
  for (std::size_t step = 0; step < parents.size() && at != kNoRow && at != row; ++step) at = parents[at];
  return at != kNoRow;
}

std::vector<KeyFrameEdge> WithIds(const Map& map, detail::RowPairs edges) {
  for (auto& [one, other] : edges)
    if (map.keyframes[other].id < map.keyframes[one].id) std::swap(one, other);
  std::vector<KeyFrameEdge> pairs;
  for (const auto& [one, other] : edges) pairs.emplace_back(map.keyframes[one].id, map.keyframes[other].id);
  std::ranges::sort(pairs);
  return pairs;
}

Column<KeyFrameId> KeyFrame::*ListOf(EdgeKind kind) {
  return kind == EdgeKind::kLoop ? &KeyFrame::loop_edges : &KeyFrame::merge_edges;
}

}  // namespace

std::vector<KeyFrameEdge> EdgesOf(const Map& map, EdgeKind kind) {
  const IdTable table = KeyFrameTable(map);
  return WithIds(map, detail::EdgesOf(map, ListOf(kind), [&](KeyFrameId id) { return table.Find(id.value()); }));
}

std::vector<KeyFrameEdge> EssentialEdges(const Map& map, int min_weight) {
  const IdTable table = KeyFrameTable(map);
  detail::RowPairs edges;
  detail::ForEachTie(map, min_weight, [&](std::uint32_t row, KeyFrameId id, detail::Tie) {
    if (const std::uint32_t other = table.Find(id.value()); other != kNoRow) edges.push_back(std::minmax(row, other));
  });
  detail::MakeDistinct(edges);
  return WithIds(map, std::move(edges));
}

void SetParents(Map& map, std::span<const KeyFrameEdge> given) {
  const IdTable table = KeyFrameTable(map);
  std::vector<std::uint32_t> parents = ParentsOf(map, table);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::uint32_t row = RowOf(table, "keyframes", i, given[i].first);
    if (given[i].first == map.first_keyframe)
      RefuseRow("keyframes", i, "is keyframe ", given[i].first.value(), ", the root, which has no parent");
    parents[row] = RowOf(table, "parents", i, given[i].second);
  }
  for (std::size_t i = 0; i < given.size(); ++i)
    if (IsOnCycle(parents, table.Find(given[i].first.value())))
      RefuseRow("parents", i, "hangs keyframe ", given[i].first.value(), " on keyframe ", given[i].second.value(),
                ", which hangs on itself then");
  for (const auto& [id, parent] : given) {
    KeyFrame& keyframe = map.keyframes[table.Find(id.value())];
    if (const std::uint32_t old = keyframe.parent ? table.Find(keyframe.parent.value()) : kNoRow; old != kNoRow)
      std::erase(map.keyframes[old].children, id);
    keyframe.parent = parent;
    keyframe.first_connection = false;
    map.keyframes[table.Find(parent.value())].children.push_back(id);
  }
}

std::uint64_t AddEdges(Map& map, EdgeKind kind, std::span<const KeyFrameEdge> edges) {
  const IdTable table = KeyFrameTable(map);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    RowOf(table, "pairs", i, edges[i].first);
    RowOf(table, "pairs", i, edges[i].second);
    if (edges[i].first == edges[i].second) RefuseRow("pairs", i, "leads from a keyframe to itself");
  }
  const auto list = ListOf(kind);
  std::uint64_t added = 0;
  for (const auto& [id, other_id] : edges) {
    KeyFrame &one = map.keyframes[table.Find(id.value())], &other = map.keyframes[table.Find(other_id.value())];
    added += std::ranges::find(one.*list, other.id) == (one.*list).end() ? 1 : 0;
    for (const auto& [from, to] : {std::pair(&one, &other), std::pair(&other, &one)}) {
      Column<KeyFrameId>& ends = from->*list;
      if (std::ranges::find(ends, to->id) == ends.end()) ends.push_back(to->id);
      from->not_erase = true;
    }
  }
  return added;
}

void SetReferences(Map& map, std::span<const std::pair<MapPointId, KeyFrameId>> references) {
  const IdTable keyframes = KeyFrameTable(map), points = PointTable(map);
  for (std::size_t i = 0; i < references.size(); ++i) {
    const std::uint32_t row = points.Find(references[i].first.value());
    if (row == kNoRow) RefuseRow("points", i, "is ", references[i].first.value(), ", which the map does not have");
    RowOf(keyframes, "keyframes", i, references[i].second);
    const Column<Observation>& seen = map.points[row].observations;
    if (std::ranges::find(seen, references[i].second, &Observation::keyframe) == seen.end())
      RefuseRow("keyframes", i, "is ", references[i].second.value(), ", which does not observe point ",
                references[i].first.value());
  }
  for (const auto& [id, keyframe] : references) {
    MapPoint& point = map.points[points.Find(id.value())];
    point.reference = keyframe;
    const DistanceRange range = detail::ObservedRange(point, map.keyframes[keyframes.Find(keyframe.value())]);
    if (!(range.max > 0)) continue;
    point.min_distance = range.min;
    point.max_distance = range.max;
  }
}

void UpdatePoints(Map& map, std::span<const std::uint32_t> rows) {
  for (const std::uint32_t row : rows)
    if (row >= map.points.size()) detail::Refuse("rows: there is no row ", row, " of ", map.points.size());
  const IdTable keyframes = KeyFrameTable(map);
  const auto find = [&](KeyFrameId id) -> const KeyFrame* {
    const std::uint32_t row = keyframes.Find(id.value());
    return row == kNoRow ? nullptr : &map.keyframes[row];
  };
  for (const std::uint32_t row : rows) {
    MapPoint& point = map.points[row];
    point.observation_count = 0;
    for (const Observation& observation : point.observations)
      if (const KeyFrame* keyframe = find(observation.keyframe))
        point.observation_count += ObservationWeight(*keyframe, observation);
    detail::RefreshView(find, false, false, point);
    const std::vector<Descriptor> descriptors = detail::ObservedDescriptors(point, find);
    if (descriptors.empty()) continue;
    point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];
    point.descriptor_form = MatrixForm::kUsual;
  }
}

void UpdateConnections(Map& map) {
  std::vector<std::uint32_t> rows(map.keyframes.size());
  std::iota(rows.begin(), rows.end(), 0U);
  detail::UpdateCovisibility(map, rows);
}

}  // namespace slamdb
