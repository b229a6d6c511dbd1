// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/g2o/detail/edges.h"

#include <algorithm>
#include <set>
#include <utility>

#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"

namespace slamdb::g2o {

bool IsVertex(const KeyFrame& keyframe) {
  return !keyframe.bad && keyframe.id && detail::IsPose(keyframe.camera_from_world);
}

EssentialGraph EssentialGraphOf(const Map& map) {
  constexpr std::int32_t kLeastWeight = 100;
  const IdTable rows = KeyFrameTable(map);
  std::vector<Edge> edges;
  std::set<std::pair<std::uint32_t, KeyFrameId>> outside;
  const auto add = [&](std::uint32_t row, KeyFrameId other, std::int32_t weight) {
    if (!other) return;
    const std::uint32_t end = rows.Find(other.value());
    if (end == row) return;
    if (end == kNoRow || !IsVertex(map.keyframes[end])) {
      outside.emplace(row, other);
      return;
    }
    const bool in_order = map.keyframes[row].id < map.keyframes[end].id;
    edges.push_back(in_order ? Edge{row, end, weight} : Edge{end, row, weight});
  };
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row];
    if (!IsVertex(keyframe)) continue;
    add(row, keyframe.parent, 0);
    for (const auto* list : {&keyframe.loop_edges, &keyframe.merge_edges})
      for (const KeyFrameId other : *list) add(row, other, 0);
    for (const Connection& connection : keyframe.connections)
      if (connection.weight >= kLeastWeight || connection.keyframe == keyframe.parent)
        add(row, connection.keyframe, connection.weight);
  }
  const auto ids = [&](const Edge& edge) {
    return std::pair(map.keyframes[edge.first].id, map.keyframes[edge.second].id);
  };
  std::ranges::sort(
      edges, [&](const Edge& a, const Edge& b) { return ids(a) != ids(b) ? ids(a) < ids(b) : a.weight > b.weight; });
  edges.erase(std::unique(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return ids(a) == ids(b); }),
              edges.end());
  return {std::move(edges), outside.size()};
}

}  // namespace slamdb::g2o
