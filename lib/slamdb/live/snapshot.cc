// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/detail/snapshot.h"

#include <algorithm>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/live/detail/link_filter.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {
namespace {

constexpr std::size_t kKeyFrameGrain = 16, kPointGrain = 4096;

// Those of one map, in the map's order; the erased ones, which have no place in it, behind.
template <class Object>
std::vector<Object*> OfMap(const std::vector<Object*>& changed, const Map* map) {
  std::vector<Object*> objects;
  for (Object* object : changed)
    if (object->Owner() == map) objects.push_back(object);
  const auto erased = std::partition(objects.begin(), objects.end(), [&](Object* o) { return o->IsListedIn(map); });
  std::sort(objects.begin(), erased, &ObjectList<Object>::IsBefore);
  return objects;
}

}  // namespace

template <class Object, class... More>
auto Bridge::RecordOf(Object& object, const Map& map, More... more) {
  LinkFilter links(&map);
  auto record = object.ToRecord(links, more...);
  if (links.waits()) object.MarkChanged();
  return record;
}

bool Bridge::HasRepeatedEntries(const Atlas& atlas) {
  return atlas.lists_as_recorded_ &&
         std::all_of(atlas.maps_.begin(), atlas.maps_.end(), [](const auto& map) { return map->lists_as_recorded_; });
}

slamdb::Atlas Bridge::Header(Atlas& atlas) {
  slamdb::Atlas header = atlas.record_;
  if (!HasRepeatedEntries(atlas)) {
    header.repeated_maps.clear();
    header.repeated_cameras.clear();
  }
  for (const auto& camera : atlas.cameras_) header.cameras.push_back(camera->record());
  header.next_ids = {.map = atlas.runtime_.map_ids.recorded(),
                     .frame = atlas.runtime_.frame_ids.recorded(),
                     .keyframe = atlas.runtime_.keyframe_ids.recorded(),
                     .map_point = atlas.runtime_.point_ids.recorded(),
                     .camera = atlas.runtime_.camera_ids.recorded(),
                     .initial_keyframe = atlas.NextInitialKeyFrame()};
  return header;
}

slamdb::Map Bridge::CopyMap(const Map& map, bool repeated_entries, int threads) {
  slamdb::Map copy = map.ToHeader(repeated_entries);
  const std::vector<KeyFrame*> keyframes = map.keyframes_.live.ToVector();
  copy.keyframes.resize(keyframes.size());
  detail::ParallelFor(keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) copy.keyframes[row] = RecordOf(*keyframes[row], map, true);
  });
  const std::vector<MapPoint*> points = map.points_.live.ToVector();
  copy.points.resize(points.size());
  detail::ParallelFor(points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) copy.points[row] = RecordOf(*points[row], map);
  });
  return copy;
}

slamdb::Atlas Bridge::Copy(Atlas& atlas, int threads) {
  slamdb::Atlas copy = Header(atlas);
  for (const auto& map : atlas.maps_)
    if (map->IsSaved()) copy.maps.push_back(CopyMap(*map, HasRepeatedEntries(atlas), threads));
  return copy;
}

// ---- what changed

void Bridge::NoteSaved(KeyFrame& keyframe) {
  keyframe.was_saved_ = true;
  keyframe.saved_members_ = keyframe.ReadPublicMembers();
}

MapSnapshot Bridge::CopyWhole(Map& map, bool repeated_entries, int threads) {
  MapSnapshot snapshot{.source = &map, .complete = true, .map = CopyMap(map, repeated_entries, threads)};
  for (KeyFrame* keyframe : map.keyframes_.live.ToVector()) NoteSaved(*keyframe);
  map.is_rebuilt_ = false;
  return snapshot;
}

MapSnapshot Bridge::CopyChanged(Map& map, bool repeated_entries, const std::vector<KeyFrame*>& keyframes,
                                const std::vector<MapPoint*>& points) {
  MapSnapshot snapshot{.source = &map, .complete = false, .map = map.ToHeader(repeated_entries)};
  snapshot.map.keyframes.reserve(keyframes.size());
  snapshot.map.points.reserve(points.size());
  for (KeyFrame* keyframe : keyframes) {
    if (!keyframe->IsListedIn(&map)) {
      snapshot.erased_keyframes.push_back(KeyFrameId(keyframe->mnId));
      continue;
    }
    snapshot.with_features.push_back(!keyframe->was_saved_);
    snapshot.map.keyframes.push_back(RecordOf(*keyframe, map, !keyframe->was_saved_));
    NoteSaved(*keyframe);
  }
  for (MapPoint* point : points) {
    if (point->IsListedIn(&map)) {
      snapshot.map.points.push_back(RecordOf(*point, map));
    } else {
      snapshot.erased_points.push_back(MapPointId(point->mnId));
    }
  }
  return snapshot;
}

// A map that is merged into another one goes bad first, and then gives up its keyframes: until those are moved or
// removed they are not lost.
std::vector<Map*> Bridge::CheckpointedMaps(Atlas& atlas) {
  std::vector<Map*> maps;
  for (const auto& map : atlas.maps_)
    if (map->IsSaved()) maps.push_back(map.get());
  for (const auto& map : atlas.bad_maps_)
    if (map->keyframes_.live.size() > 0) maps.push_back(map.get());
  return maps;
}

// Those in the log, and those of which a client wrote a public member without a word.
std::vector<KeyFrame*> Bridge::TakeChangedKeyFrames(Atlas& atlas) {
  for (const Map* map : CheckpointedMaps(atlas))
    for (KeyFrame* keyframe : map->keyframes_.live.ToVector())
      if (keyframe->saved_members_ != keyframe->ReadPublicMembers()) keyframe->MarkChanged();
  return atlas.runtime_.changed_keyframes.Take();
}

Snapshot Bridge::TakeChanges(Atlas& atlas, bool everything, int threads) {
  Snapshot snapshot{.header = Header(atlas)};
  const std::vector<KeyFrame*> keyframes = TakeChangedKeyFrames(atlas);
  const std::vector<MapPoint*> points = atlas.runtime_.changed_points.Take();
  const bool repeated = HasRepeatedEntries(atlas);
  for (Map* map : CheckpointedMaps(atlas)) {
    if (everything || map->is_rebuilt_ || !map->has_unique_ids_) {
      snapshot.maps.push_back(CopyWhole(*map, repeated, threads));
    } else {
      snapshot.maps.push_back(CopyChanged(*map, repeated, OfMap(keyframes, map), OfMap(points, map)));
    }
  }
  return snapshot;
}

void Bridge::ForgetChanges(Runtime& runtime, const std::function<bool(Map*)>& goes) {
  for (KeyFrame* keyframe : runtime.changed_keyframes.Take())
    if (!goes(keyframe->Owner())) runtime.changed_keyframes.Add(keyframe);
  for (MapPoint* point : runtime.changed_points.Take())
    if (!goes(point->Owner())) runtime.changed_points.Add(point);
}

}  // namespace slamdb::live
