// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <type_traits>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/edit/ids/id_kind.h"
#include "slamdb/model/atlas.h"

// Every place in an atlas where an id stands, in one list, so that whatever moves or reads ids forgets none. Ids stand
// in fields of several types: strong ids, int64 with -1 for none, and 32 bits for origin maps.
namespace slamdb::detail {

template <IdKind kind>
using IdKindConstant = std::integral_constant<IdKind, kind>;

// visit(kind, field) for each id that a keyframe names, its own first. `kind` is an IdKindConstant, `field` a reference
// to the field, const when the entity is.
template <class AKeyFrame, class Visit>
requires std::is_same_v<std::remove_const_t<AKeyFrame>, KeyFrame>
void VisitIds(AKeyFrame& keyframe, const Visit& visit) {
  constexpr IdKindConstant<IdKind::kKeyFrame> kKeyFrame;
  visit(kKeyFrame, keyframe.id);
  visit(IdKindConstant<IdKind::kFrame>(), keyframe.frame_id);
  visit(IdKindConstant<IdKind::kCamera>(), keyframe.camera);
  visit(IdKindConstant<IdKind::kCamera>(), keyframe.right_camera);
  visit(IdKindConstant<IdKind::kMap>(), keyframe.origin_map);
  for (auto& point : keyframe.features.map_points) visit(IdKindConstant<IdKind::kPoint>(), point);
  for (auto& connection : keyframe.connections) visit(kKeyFrame, connection.keyframe);
  visit(kKeyFrame, keyframe.parent);
  for (auto& child : keyframe.children) visit(kKeyFrame, child);
  for (auto& other : keyframe.loop_edges) visit(kKeyFrame, other);
  for (auto& other : keyframe.merge_edges) visit(kKeyFrame, other);
  visit(kKeyFrame, keyframe.previous);
  visit(kKeyFrame, keyframe.next);
}

// Likewise for a map point.
template <class AMapPoint, class Visit>
requires std::is_same_v<std::remove_const_t<AMapPoint>, MapPoint>
void VisitIds(AMapPoint& point, const Visit& visit) {
  constexpr IdKindConstant<IdKind::kKeyFrame> kKeyFrame;
  visit(IdKindConstant<IdKind::kPoint>(), point.id);
  visit(kKeyFrame, point.first_keyframe);
  visit(IdKindConstant<IdKind::kFrame>(), point.first_frame);
  if (point.origin_map != MapPoint::kNoOrigin) visit(IdKindConstant<IdKind::kMap>(), point.origin_map);
  for (auto& observation : point.observations) visit(kKeyFrame, observation.keyframe);
  visit(kKeyFrame, point.reference);
  visit(IdKindConstant<IdKind::kPoint>(), point.replaced_by);
}

// Likewise for a map, without its keyframes and points.
template <class AMap, class Visit>
requires std::is_same_v<std::remove_const_t<AMap>, Map>
void VisitIds(AMap& map, const Visit& visit) {
  constexpr IdKindConstant<IdKind::kKeyFrame> kKeyFrame;
  visit(IdKindConstant<IdKind::kMap>(), map.id);
  visit(kKeyFrame, map.initial_keyframe);
  visit(kKeyFrame, map.max_keyframe_id);
  for (auto& origin : map.origins) visit(kKeyFrame, origin);
  for (auto& landmark : map.landmarks) visit(IdKindConstant<IdKind::kPoint>(), landmark.id);  // that of its point
  visit(kKeyFrame, map.first_keyframe);
  visit(kKeyFrame, map.lowest_keyframe);
}

// Likewise for a camera.
template <class ACamera, class Visit>
requires std::is_same_v<std::remove_const_t<ACamera>, Camera>
void VisitIds(ACamera& camera, const Visit& visit) { visit(IdKindConstant<IdKind::kCamera>(), camera.id); }

// Likewise for everything in an atlas.
template <class AnAtlas, class Visit>
requires std::is_same_v<std::remove_const_t<AnAtlas>, Atlas>
void VisitIds(AnAtlas& atlas, const Visit& visit) {
  for (auto& camera : atlas.cameras) VisitIds(camera, visit);
  for (auto& map : atlas.maps) {
    VisitIds(map, visit);
    for (auto& keyframe : map.keyframes) VisitIds(keyframe, visit);
    for (auto& point : map.points) VisitIds(point, visit);
  }
}

// The id in a field of any of the types; kNoId for none.
template <class Entity>
std::uint64_t IdValue(Id<Entity> id) {
  return id.value();
}
inline std::uint64_t IdValue(std::uint64_t id) { return id; }
inline std::uint64_t IdValue(std::int64_t id) { return static_cast<std::uint64_t>(id); }
inline std::uint64_t IdValue(std::uint32_t id) { return id; }

template <class Entity>
void SetIdValue(Id<Entity>& field, std::uint64_t id) {
  field = Id<Entity>(id);
}
template <class Integer>
requires std::is_integral_v<Integer>
void SetIdValue(Integer& field, std::uint64_t id) { field = static_cast<Integer>(id); }

// Replaces each id of the entity by translate(kind, id); none stays none.
template <class Entity, class Translate>
void TranslateIds(Entity& entity, const Translate& translate) {
  VisitIds(entity, [&](auto kind, auto& field) {
    const std::uint64_t id = IdValue(field);
    if (id != kNoId) SetIdValue(field, translate(kind, id));
  });
}

// Lists that files hold by keyframe id are put back into that order.
template <class List, class Projection>
void SortById(List& list, const Projection& projection) {
  if (!std::ranges::is_sorted(list, {}, projection)) std::ranges::stable_sort(list, {}, projection);
}

// The largest and the smallest keyframe id of a map; `none` for a map without keyframes.
inline KeyFrameId LargestKeyFrame(const Map& map) {
  const auto found = std::ranges::max_element(map.keyframes, {}, &KeyFrame::id);
  return found == map.keyframes.end() ? KeyFrameId() : found->id;
}
inline KeyFrameId SmallestKeyFrame(const Map& map) {
  const auto found = std::ranges::min_element(map.keyframes, {}, &KeyFrame::id);
  return found == map.keyframes.end() ? KeyFrameId() : found->id;
}

// Replaces every id of an atlas by translate(kind, id), on `threads` threads (0: every core). What is a smallest or
// largest id, or sorted by id, is so afterwards too. Counters stay. `translate` is called from several threads.
template <class Translate>
void TranslateAtlas(Atlas& atlas, const Translate& translate, int threads) {
  constexpr std::size_t kKeyFrameGrain = 16, kPointGrain = 4096;
  for (Camera& camera : atlas.cameras) TranslateIds(camera, translate);
  for (Map& map : atlas.maps) {
    const bool lowest_is_exact = map.lowest_keyframe == SmallestKeyFrame(map);
    const bool largest_is_exact = map.max_keyframe_id == LargestKeyFrame(map).value();
    TranslateIds(map, translate);
    ParallelFor(map.keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        TranslateIds(map.keyframes[row], translate);
        SortById(map.keyframes[row].connections, &Connection::keyframe);
      }
    });
    ParallelFor(map.points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        TranslateIds(map.points[row], translate);
        SortById(map.points[row].observations, &Observation::keyframe);
      }
    });
    if (map.keyframes.empty()) continue;
    const std::uint64_t largest = LargestKeyFrame(map).value();
    if (lowest_is_exact) map.lowest_keyframe = SmallestKeyFrame(map);
    map.max_keyframe_id = largest_is_exact ? largest : std::max(map.max_keyframe_id, largest);
  }
}

}  // namespace slamdb::detail
