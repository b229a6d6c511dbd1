// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "slamdb/live/atlas.h"
#include "slamdb/live/map.h"
#include "slamdb/live/post_load.h"
#include "slamdb/model/atlas.h"

// Copies of a live atlas, and of what changed in it.
namespace slamdb::live {

struct LinkTargets;

// One map. Links lead only to what the map lists.
struct MapSnapshot {
  const Map* source = nullptr;
  bool complete = false;  // all objects of the map; otherwise those that changed, in the map's order
  slamdb::Map map;
  std::vector<bool> with_features;  // by keyframe: false, only point slots are in its Features
  std::vector<KeyFrameId> erased_keyframes;
  std::vector<MapPointId> erased_points;
};

struct Snapshot {
  slamdb::Atlas header;  // without maps
  std::vector<MapSnapshot> maps;
};

// What reaches into the live classes. All but Fill want the gate closed.
struct Bridge {
  static void Fill(Atlas& atlas, slamdb::Atlas model, int threads, PostLoadReport& report);  // of a new, empty one
  static slamdb::Atlas Copy(Atlas& atlas, int threads);

  // What changed since this was last called, or everything. One checkpointer at a time uses it.
  static Snapshot TakeChanges(Atlas& atlas, bool everything, int threads);

  // Takes what goes out of the change log before it is deleted.
  static void ForgetChanges(Runtime& runtime, const std::function<bool(Map*)>& goes);

  // One checkpointer at a time. False: there is one.
  static bool Claim(Atlas& atlas) { return !atlas.has_checkpointer_.exchange(true); }
  static void Release(Atlas& atlas) { atlas.has_checkpointer_ = false; }

 private:
  static void FillMap(Atlas& atlas, slamdb::Map record, int threads, PostLoadReport& report);
  template <class Objects, class Object>
  static void List(Map& map, Objects& objects, const std::vector<Object*>& all);
  static void LinkMap(Atlas& atlas, Map& map, const Column<slamdb::MapPoint>& point_records, const LinkTargets& targets,
                      int threads, PostLoadReport& report);
  static void LinkHeader(Map& map, const LinkTargets& targets, PostLoadReport& report);

  static std::vector<Map*> CheckpointedMaps(Atlas& atlas);
  // The object's record. What links to an object that is in no map yet counts as changed until that is added.
  template <class Object, class... More>
  static auto RecordOf(Object& object, const Map& map, More... more);
  static slamdb::Atlas Header(Atlas& atlas);
  static bool HasRepeatedEntries(const Atlas& atlas);  // that still hold
  static slamdb::Map CopyMap(const Map& map, bool repeated_entries, int threads);
  static MapSnapshot CopyWhole(Map& map, bool repeated_entries, int threads);
  static MapSnapshot CopyChanged(Map& map, bool repeated_entries, const std::vector<KeyFrame*>& keyframes,
                                 const std::vector<MapPoint*>& points);
  static std::vector<KeyFrame*> TakeChangedKeyFrames(Atlas& atlas);
  static void NoteSaved(KeyFrame& keyframe);
};

}  // namespace slamdb::live
