// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_unrecorded.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/merge/detail/branch_geometry.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/carried_members.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

bool HasLandmarks(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) { return !map.landmarks.empty(); });
}

bool HasTracking(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.points, [](const MapPoint& point) { return point.has_tracking(); });
  });
}

void TakeTracking(const MapPoint& before, MapPoint& point) {
  point.origin_map = before.origin_map;
  point.visible_count = before.visible_count;
  point.found_count = before.found_count;
}

void TakeMembers(const Boxed<Carried>& before, Boxed<Carried>& carried) {
  if (HasMembers(before)) carried.Make().members = before->members;
}

class Taker {
 public:
  Taker(const Unrecorded& what, const Atlas& base, const PointClasses& classes, int threads, Atlas& side)
      : what_(what), base_(base), classes_(classes), threads_(threads), side_(side) {}

  std::vector<PlacesOfPoints> Run() {
    if (what_.tracking || what_.members) TakePoints();
    if (what_.members) TakeOtherMembers();
    std::vector<PlacesOfPoints> places(side_.maps.size());
    if (what_.landmarks)
      for (const Map& map : base_.maps)
        if (!map.landmarks.empty()) TakeLandmarks(map, places);
    places.resize(side_.maps.size());
    return places;
  }

 private:
  void TakePoints() {
    for (Map& map : side_.maps)
      for (MapPoint& point : map.points) {
        const EntityRow place = in_base_.LocatePoint(point.id);
        if (!place) continue;
        const MapPoint& before = base_.maps[place.map].points[place.row];
        if (what_.tracking) TakeTracking(before, point);
        if (what_.members) TakeMembers(before.carried, point.carried);
      }
  }

  void TakeOtherMembers() {
    TakeMembers(base_.carried, side_.carried);
    for (Camera& camera : side_.cameras)
      if (const auto before = std::ranges::find(base_.cameras, camera.id, &Camera::id); before != base_.cameras.end())
        TakeMembers(before->carried, camera.carried);
    for (const Map& map : base_.maps)
      if (const auto row = RowOf(map)) TakeMembers(map.carried, side_.maps[*row].carried);
    for (Map& map : side_.maps)
      for (KeyFrame& keyframe : map.keyframes)
        if (const EntityRow place = in_base_.LocateKeyFrame(keyframe.id))
          TakeMembers(base_.maps[place.map].keyframes[place.row].carried, keyframe.carried);
  }

  static bool IsCloud(const Map& map) { return map.keyframes.empty() && map.points.empty(); }

  // Which map of the side a map of the base is by now.
  std::optional<std::size_t> RowOf(const Map& map) const {
    for (const KeyFrame& keyframe : map.keyframes)
      if (const EntityRow place = in_side_.LocateKeyFrame(keyframe.id)) return place.map;
    if (!map.keyframes.empty()) return std::nullopt;
    const auto same =
        std::ranges::find_if(side_.maps, [&](const Map& each) { return each.id == map.id && each.keyframes.empty(); });
    if (same == side_.maps.end()) return std::nullopt;
    return static_cast<std::size_t>(same - side_.maps.begin());
  }

  void TakeLandmarks(const Map& map, std::vector<PlacesOfPoints>& places) {
    const std::optional<std::size_t> row = RowOf(map);
    if (!row) {
      if (IsCloud(map)) AddCloud(map);
      return;
    }
    Map before;  // in the frame of the side
    before.points = map.points;
    before.landmarks = map.landmarks;
    Map& now = side_.maps[*row];
    if (const auto moved = ToAnotherFrame(now, map)) TransformMap(before, *moved, threads_);
    const PlacesOfPoints was = PlacesOf(before, classes_), is = PlacesOf(now, classes_);
    for (Landmark& landmark : before.landmarks) {
      const auto place = landmark.is_numbered() ? was.find(landmark.id.value()) : was.end();
      if (place != was.end() && !is.contains(place->first)) continue;  // its point was deleted
      if (place != was.end()) places[*row].insert(*place);
      now.landmarks.push_back(std::move(landmark));
    }
  }

  void AddCloud(const Map& map) {
    const bool is_taken = std::ranges::any_of(side_.maps, [&](const Map& each) { return each.id == map.id; });
    Map& added = side_.maps.emplace_back(map);
    if (is_taken) added.id = MapId(side_.next_ids.map);
    RaiseCounters(side_);
  }

  const Unrecorded& what_;
  const Atlas& base_;
  const PointClasses& classes_;
  const int threads_;
  Atlas& side_;
  const AtlasIndex in_base_{base_}, in_side_{side_};
};

}  // namespace

bool HasMembersOfAFork(const Atlas& atlas) {
  bool has_any = false;
  ForEachCarried(atlas, [&](const Boxed<Carried>& carried) { has_any = has_any || HasMembers(carried); });
  return has_any;
}

Unrecorded UnrecordedIn(const Atlas& side, const Atlas& base) {
  return {.landmarks = HasLandmarks(base) && !HasLandmarks(side),
          .tracking = HasTracking(base) && !HasTracking(side),
          .members = base.layout != side.layout && HasMembersOfAFork(base)};
}

Atlas Without(const Unrecorded& what, Atlas base, const Atlas& side) {
  for (Map& map : base.maps) {
    if (what.landmarks) map.landmarks.clear();
    if (what.tracking)
      for (MapPoint& point : map.points) TakeTracking(MapPoint(), point);
  }
  if (what.members) {
    ForEachCarried(base, [](Boxed<Carried>& carried) { DropMembers(carried); });
    base.layout = side.layout;
  }
  return base;
}

std::vector<PlacesOfPoints> TakeOver(const Unrecorded& what, const Atlas& base, const PointClasses& classes,
                                     int threads, Atlas& side) {
  return Taker(what, base, classes, threads, side).Run();
}

}  // namespace slamdb::detail
