// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/detail/replica.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "slamdb/model/index.h"

namespace slamdb::live {
namespace {

template <class Entity>
using IdSet = std::unordered_set<Id<Entity>>;

// Features of a keyframe hold still but for the point slots.
void KeepFeatures(Features& before, Features& now) {
  before.map_points = std::move(now.map_points);
  now = std::move(before);
}

void UpdateKeyFrames(slamdb::Map& map, Column<slamdb::KeyFrame> changed, const std::vector<bool>& with_features) {
  const IdTable rows = KeyFrameTable(map);
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const std::uint32_t row = rows.Find(changed[i].id.value());
    if (row == kNoRow) {
      map.keyframes.push_back(std::move(changed[i]));
      continue;
    }
    if (!with_features[i]) KeepFeatures(map.keyframes[row].features, changed[i].features);
    map.keyframes[row] = std::move(changed[i]);
  }
}

void UpdatePoints(slamdb::Map& map, Column<slamdb::MapPoint> changed) {
  if (changed.empty()) return;
  const IdTable rows = PointTable(map);
  for (slamdb::MapPoint& point : changed) {
    const std::uint32_t row = rows.Find(point.id.value());
    if (row == kNoRow) {
      map.points.push_back(std::move(point));
    } else {
      map.points[row] = std::move(point);
    }
  }
}

// Removes what was erased, and every link to it that somebody still has. Bad entries of the lists are no part of the
// graph: they stay as they were recorded.
void RemoveKeyFrames(slamdb::Map& map, const IdSet<slamdb::KeyFrame>& gone) {
  if (gone.empty()) return;
  const auto is_gone = [&](KeyFrameId id) { return gone.contains(id); };
  const auto clear = [&](KeyFrameId& id) {
    if (is_gone(id)) id = {};
  };
  std::erase_if(map.keyframes, [&](const slamdb::KeyFrame& keyframe) { return is_gone(keyframe.id); });
  for (slamdb::KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    std::erase_if(keyframe.connections, [&](const Connection& c) { return is_gone(c.keyframe); });
    for (Column<KeyFrameId>* links : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges})
      std::erase_if(*links, is_gone);
    for (KeyFrameId* link : {&keyframe.parent, &keyframe.previous, &keyframe.next}) clear(*link);
  }
  for (slamdb::MapPoint& point : map.points) {
    if (point.bad) continue;
    std::erase_if(point.observations, [&](const Observation& o) { return is_gone(o.keyframe); });
    if (is_gone(point.reference))
      point.reference = point.observations.empty() ? KeyFrameId() : point.observations.front().keyframe;
  }
}

void RemovePoints(slamdb::Map& map, const IdSet<slamdb::MapPoint>& gone) {
  if (gone.empty()) return;
  std::erase_if(map.points, [&](const slamdb::MapPoint& point) { return gone.contains(point.id); });
  for (slamdb::MapPoint& point : map.points)
    if (!point.bad && gone.contains(point.replaced_by)) point.replaced_by = {};
  for (slamdb::KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    for (MapPointId& slot : keyframe.features.map_points)
      if (slot && gone.contains(slot)) slot = {};
  }
}

slamdb::Map Update(slamdb::Map before, MapSnapshot snapshot) {
  slamdb::Map now = std::move(snapshot.map);
  Column<slamdb::KeyFrame> keyframes = std::exchange(now.keyframes, std::move(before.keyframes));
  Column<slamdb::MapPoint> points = std::exchange(now.points, std::move(before.points));
  RemoveKeyFrames(now, {snapshot.erased_keyframes.begin(), snapshot.erased_keyframes.end()});
  RemovePoints(now, {snapshot.erased_points.begin(), snapshot.erased_points.end()});
  UpdateKeyFrames(now, std::move(keyframes), snapshot.with_features);
  UpdatePoints(now, std::move(points));
  return now;
}

}  // namespace

void Replica::Apply(Snapshot snapshot) {
  std::vector<slamdb::Map> before = std::move(atlas_.maps);
  const std::vector<const Map*> sources_before = std::move(sources_);
  atlas_ = std::move(snapshot.header);
  atlas_.maps.clear();
  sources_.clear();
  for (MapSnapshot& map : snapshot.maps) {
    const auto found = std::find(sources_before.begin(), sources_before.end(), map.source);
    sources_.push_back(map.source);
    if (map.complete || found == sources_before.end()) {
      atlas_.maps.push_back(std::move(map.map));
    } else {
      atlas_.maps.push_back(
          Update(std::move(before[static_cast<std::size_t>(found - sources_before.begin())]), std::move(map)));
    }
  }
}

}  // namespace slamdb::live
