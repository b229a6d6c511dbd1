// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam2/detail/link.h"

#include <algorithm>
#include <numeric>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::orbslam2 {
namespace {

// By row.
template <class Entity>
std::vector<Id<Entity>> IdsOf(const Column<Entity>& entities) {
  std::vector<Id<Entity>> ids(entities.size());
  std::transform(entities.begin(), entities.end(), ids.begin(), [](const Entity& entity) { return entity.id; });
  return ids;
}

template <class Entity>
void ToId(const std::vector<Id<Entity>>& ids, Id<Entity>& link) {
  if (link.has_value()) link = ids[link.value()];
}

void SortByKeyFrame(auto& links) {
  std::stable_sort(links.begin(), links.end(), [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; });
}

// Sorts by id without moving large entities more than once.
template <class Entity>
void SortEntities(Column<Entity>& entities) {
  std::vector<std::uint32_t> order(entities.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return entities[a].id < entities[b].id; });
  Column<Entity> sorted;
  sorted.reserve(entities.size());
  for (const std::uint32_t row : order) sorted.push_back(std::move(entities[row]));
  entities = std::move(sorted);
}

void LinkKeyFrame(KeyFrame& keyframe, const std::vector<KeyFrameId>& keyframe_ids,
                  const std::vector<MapPointId>& point_ids) {
  for (MapPointId& point : keyframe.features.map_points) ToId(point_ids, point);
  for (Connection& connection : keyframe.connections) ToId(keyframe_ids, connection.keyframe);
  SortByKeyFrame(keyframe.connections);
  ToId(keyframe_ids, keyframe.parent);
  for (Column<KeyFrameId>* links : {&keyframe.children, &keyframe.loop_edges}) {
    for (KeyFrameId& link : *links) ToId(keyframe_ids, link);
    std::sort(links->begin(), links->end());
  }
}

void LinkPoint(MapPoint& point, const std::vector<KeyFrameId>& keyframe_ids, const std::vector<MapPointId>& point_ids) {
  for (Observation& observation : point.observations) ToId(keyframe_ids, observation.keyframe);
  SortByKeyFrame(point.observations);
  ToId(keyframe_ids, point.reference);
  ToId(point_ids, point.replaced_by);
}

}  // namespace

void LinkObjects(Map& map, int threads) {
  const std::vector<KeyFrameId> keyframe_ids = IdsOf(map.keyframes);
  const std::vector<MapPointId> point_ids = IdsOf(map.points);
  for (KeyFrameId& origin : map.origins) ToId(keyframe_ids, origin);
  constexpr std::size_t kGrain = 16;
  detail::ParallelFor(map.keyframes.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) LinkKeyFrame(map.keyframes[row], keyframe_ids, point_ids);
  });
  detail::ParallelFor(map.points.size(), kGrain * kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) LinkPoint(map.points[row], keyframe_ids, point_ids);
  });
  SortEntities(map.keyframes);
  SortEntities(map.points);
}

}  // namespace slamdb::orbslam2
