// SPDX-License-Identifier: BSD-3-Clause
// References: every id leads to an entity of the same map, and to one that is not bad.
#include <algorithm>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

using Links = Column<KeyFrameId> KeyFrame::*;

void CheckLinks(const Subject& subject, Links links, const char* role, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    for (const KeyFrameId target : keyframe.*links)
      if (subject.index.KeyFrameRow(row, target) == kNoRow)
        findings.Add(PlaceOf(map, keyframe), role, " ", target, Absence(subject, target));
  });
}

// Applies erase(index, map row, keyframe) to every keyframe; it returns how much it erased.
template <class Erase>
std::size_t EraseInKeyFrames(Atlas& atlas, const Erase& erase) {
  const AtlasIndex index(atlas);
  std::size_t erased = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (KeyFrame& keyframe : atlas.maps[row].keyframes) erased += erase(index, row, keyframe);
  return erased;
}

std::size_t EraseDanglingLinks(Atlas& atlas, Links links) {
  return EraseInKeyFrames(atlas, [&](const AtlasIndex& index, std::size_t row, KeyFrame& keyframe) {
    return std::erase_if(keyframe.*links, [&](KeyFrameId target) { return index.KeyFrameRow(row, target) == kNoRow; });
  });
}

void CheckMapLink(const Subject& subject, KeyFrameId Map::*link, const char* role, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Map& map = subject.atlas.maps[row];
    if (map.keyframes.empty()) continue;  // what an empty map records is uninitialised
    if (subject.index.KeyFrameRow(row, map.*link) == kNoRow)
      findings.Add(PlaceOf(map), role, " ", map.*link, Absence(subject, map.*link));
  }
}

// The id of the keyframe with the lowest id; none in an empty map.
KeyFrameId LowestKeyFrame(const Map& map) {
  KeyFrameId lowest;
  for (const KeyFrame& keyframe : map.keyframes) lowest = std::min(lowest, keyframe.id);
  return lowest;
}

// The keyframe that takes over as initial one: a root of the spanning tree if there is any, the lowest id of those.
KeyFrameId EarliestRoot(const Map& map) {
  KeyFrameId root;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.bad && !keyframe.parent) root = std::min(root, keyframe.id);
  return root ? root : LowestKeyFrame(map);
}

// Sets a link of the map that leads nowhere to the same keyframe as `other`, which is to be the same one.
std::size_t SetMapLinks(Atlas& atlas, KeyFrameId Map::*link, KeyFrameId Map::*other) {
  std::size_t changed = 0;
  for (Map& map : atlas.maps) {
    const IdTable rows = KeyFrameTable(map);
    if (map.keyframes.empty() || rows.Find((map.*link).value()) != kNoRow) continue;
    const KeyFrameId chosen = rows.Find((map.*other).value()) != kNoRow ? map.*other : EarliestRoot(map);
    if (!chosen) continue;
    map.*link = chosen;
    ++changed;
  }
  return changed;
}

// The observer that takes over as reference: the one with the lowest id that has the point in its image.
KeyFrameId FirstObserver(const AtlasIndex& index, std::size_t map, const MapPoint& point) {
  KeyFrameId first;
  for (const Observation& observation : point.observations) {
    const KeyFrame* keyframe = index.FindKeyFrame(map, observation.keyframe);
    if (keyframe == nullptr || keyframe->bad) continue;
    if (LeftRowFits(keyframe->features, observation) || RightRowFits(keyframe->features, observation))
      first = std::min(first, observation.keyframe);
  }
  return first;
}

}  // namespace

void CheckObservationTarget(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    for (const Observation& observation : point.observations)
      if (subject.index.KeyFrameRow(row, observation.keyframe) == kNoRow)
        findings.Add(PlaceOf(map, point), "observed by ", observation.keyframe, Absence(subject, observation.keyframe));
  });
}

std::size_t EraseDanglingObservations(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t erased = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (MapPoint& point : atlas.maps[row].points)
      erased += std::erase_if(point.observations, [&](const Observation& observation) {
        return index.KeyFrameRow(row, observation.keyframe) == kNoRow;
      });
  return erased;
}

void CheckReferenceTarget(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    if (subject.index.KeyFrameRow(row, point.reference) == kNoRow)
      findings.Add(PlaceOf(map, point), "reference keyframe ", point.reference, Absence(subject, point.reference));
  });
}

// Points without any usable observer keep what they have.
std::size_t ReplaceMissingReferences(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t replaced = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (MapPoint& point : atlas.maps[row].points) {
      if (point.bad || index.KeyFrameRow(row, point.reference) != kNoRow) continue;
      const KeyFrameId observer = FirstObserver(index, row, point);
      if (!observer) continue;
      point.reference = observer;
      ++replaced;
    }
  return replaced;
}

void CheckReplacementTarget(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    if (point.replaced_by && subject.index.PointRow(row, point.replaced_by) == kNoRow)
      findings.Add(PlaceOf(map, point), "replaced by ", point.replaced_by, Absence(subject, point.replaced_by));
  });
}

std::size_t ClearDanglingReplacements(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t cleared = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (MapPoint& point : atlas.maps[row].points) {
      if (!point.replaced_by || index.PointRow(row, point.replaced_by) != kNoRow) continue;
      point.replaced_by = MapPointId();
      ++cleared;
    }
  return cleared;
}

void CheckSlotTarget(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const Column<MapPointId>& slots = keyframe.features.map_points;
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      if (slots[slot] && subject.index.PointRow(row, slots[slot]) == kNoRow)
        findings.Add(PlaceOf(map, keyframe, slot), "sees ", slots[slot], Absence(subject, slots[slot]));
  });
}

std::size_t EmptyDanglingSlots(Atlas& atlas) {
  return EraseInKeyFrames(atlas, [&](const AtlasIndex& index, std::size_t row, KeyFrame& keyframe) {
    std::size_t emptied = 0;
    for (MapPointId& slot : keyframe.features.map_points) {
      if (!slot || index.PointRow(row, slot) != kNoRow) continue;
      slot = MapPointId();
      ++emptied;
    }
    return emptied;
  });
}

void CheckConnectionTarget(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    for (const Connection& connection : keyframe.connections)
      if (subject.index.KeyFrameRow(row, connection.keyframe) == kNoRow)
        findings.Add(PlaceOf(map, keyframe), "covisible with ", connection.keyframe,
                     Absence(subject, connection.keyframe));
  });
}

std::size_t EraseDanglingConnections(Atlas& atlas) {
  return EraseInKeyFrames(atlas, [&](const AtlasIndex& index, std::size_t row, KeyFrame& keyframe) {
    return std::erase_if(keyframe.connections, [&](const Connection& connection) {
      return index.KeyFrameRow(row, connection.keyframe) == kNoRow;
    });
  });
}

void CheckParentTarget(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    if (keyframe.parent && subject.index.KeyFrameRow(row, keyframe.parent) == kNoRow)
      findings.Add(PlaceOf(map, keyframe), "parent ", keyframe.parent, Absence(subject, keyframe.parent));
  });
}

// The tree rules give the keyframe another one.
std::size_t ClearDanglingParents(Atlas& atlas) {
  return EraseInKeyFrames(atlas, [](const AtlasIndex& index, std::size_t row, KeyFrame& keyframe) -> std::size_t {
    if (!keyframe.parent || index.KeyFrameRow(row, keyframe.parent) != kNoRow) return 0;
    keyframe.parent = KeyFrameId();
    return 1;
  });
}

void CheckChildTarget(const Subject& subject, Findings& findings) {
  CheckLinks(subject, &KeyFrame::children, "child", findings);
}
std::size_t EraseDanglingChildren(Atlas& atlas) { return EraseDanglingLinks(atlas, &KeyFrame::children); }

void CheckLoopEdgeTarget(const Subject& subject, Findings& findings) {
  CheckLinks(subject, &KeyFrame::loop_edges, "loop edge to", findings);
}
std::size_t EraseDanglingLoopEdges(Atlas& atlas) { return EraseDanglingLinks(atlas, &KeyFrame::loop_edges); }

void CheckMergeEdgeTarget(const Subject& subject, Findings& findings) {
  CheckLinks(subject, &KeyFrame::merge_edges, "merge edge to", findings);
}
std::size_t EraseDanglingMergeEdges(Atlas& atlas) { return EraseDanglingLinks(atlas, &KeyFrame::merge_edges); }

void CheckTemporalTarget(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    if (keyframe.previous && subject.index.KeyFrameRow(row, keyframe.previous) == kNoRow)
      findings.Add(PlaceOf(map, keyframe), "previous ", keyframe.previous, Absence(subject, keyframe.previous));
    if (keyframe.next && subject.index.KeyFrameRow(row, keyframe.next) == kNoRow)
      findings.Add(PlaceOf(map, keyframe), "next ", keyframe.next, Absence(subject, keyframe.next));
  });
}

std::size_t ClearDanglingNeighbours(Atlas& atlas) {
  return EraseInKeyFrames(atlas, [&](const AtlasIndex& index, std::size_t row, KeyFrame& keyframe) {
    std::size_t cleared = 0;
    for (KeyFrameId* neighbour : {&keyframe.previous, &keyframe.next}) {
      if (!*neighbour || index.KeyFrameRow(row, *neighbour) != kNoRow) continue;
      *neighbour = KeyFrameId();
      ++cleared;
    }
    return cleared;
  });
}

void CheckSelfLink(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const auto report = [&](const char* role, bool found) {
      if (found) findings.Add(PlaceOf(map, keyframe), "is its own ", role);
    };
    const auto has_itself = [&](const Column<KeyFrameId>& links) {
      return std::ranges::find(links, keyframe.id) != links.end();
    };
    const auto& connections = keyframe.connections;
    if (!keyframe.id) return;
    report("neighbour in the covisibility graph",
           std::ranges::find(connections, keyframe.id, &Connection::keyframe) != connections.end());
    report("child", has_itself(keyframe.children));
    report("loop edge", has_itself(keyframe.loop_edges));
    report("merge edge", has_itself(keyframe.merge_edges));
    report("previous keyframe", keyframe.previous == keyframe.id);
    report("next keyframe", keyframe.next == keyframe.id);
  });
}

std::size_t EraseSelfLinks(Atlas& atlas) {
  return EraseInKeyFrames(atlas, [](const AtlasIndex&, std::size_t, KeyFrame& keyframe) -> std::size_t {
    if (!keyframe.id) return 0;
    std::size_t erased = std::erase_if(
        keyframe.connections, [&](const Connection& connection) { return connection.keyframe == keyframe.id; });
    for (auto* links : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges})
      erased += std::erase(*links, keyframe.id);
    for (KeyFrameId* neighbour : {&keyframe.previous, &keyframe.next}) {
      if (*neighbour != keyframe.id) continue;
      *neighbour = KeyFrameId();
      ++erased;
    }
    return erased;
  });
}

void CheckInitialKeyFrame(const Subject& subject, Findings& findings) {
  CheckMapLink(subject, &Map::first_keyframe, "initial keyframe", findings);
}

void CheckFixedKeyFrame(const Subject& subject, Findings& findings) {
  CheckMapLink(subject, &Map::initial_keyframe, "keyframe that bundle adjustment fixes,", findings);
}

std::size_t SetInitialKeyFrames(Atlas& atlas) {
  return SetMapLinks(atlas, &Map::first_keyframe, &Map::initial_keyframe);
}
std::size_t SetFixedKeyFrames(Atlas& atlas) { return SetMapLinks(atlas, &Map::initial_keyframe, &Map::first_keyframe); }

void CheckInitialKeyFrameIsFixed(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    if (!map.keyframes.empty() && map.first_keyframe != map.initial_keyframe)
      findings.Add(PlaceOf(map), "the initial keyframe is ", map.first_keyframe, ", but bundle adjustment fixes ",
                   map.initial_keyframe);
}

// Of the two the one that is a root of the spanning tree; the initial one when both or none are.
std::size_t FixInitialKeyFrames(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    Map& map = atlas.maps[row];
    const KeyFrame* first = index.FindKeyFrame(row, map.first_keyframe);
    const KeyFrame* fixed = index.FindKeyFrame(row, map.initial_keyframe);
    if (first == nullptr || fixed == nullptr || first == fixed) continue;
    if (first->parent && !fixed->parent)
      map.first_keyframe = map.initial_keyframe;
    else
      map.initial_keyframe = map.first_keyframe;
    ++changed;
  }
  return changed;
}

void CheckLowestKeyFrame(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    if (const KeyFrameId lowest = LowestKeyFrame(map); lowest && map.lowest_keyframe != lowest)
      findings.Add(PlaceOf(map), "the lowest keyframe is recorded as ", map.lowest_keyframe, ", but it is ", lowest);
}

std::size_t SetLowestKeyFrames(Atlas& atlas) {
  std::size_t changed = 0;
  for (Map& map : atlas.maps) {
    const KeyFrameId lowest = LowestKeyFrame(map);
    if (!lowest || map.lowest_keyframe == lowest) continue;
    map.lowest_keyframe = lowest;
    ++changed;
  }
  return changed;
}

void CheckOriginTarget(const Subject& subject, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row)
    for (const KeyFrameId origin : subject.atlas.maps[row].origins)
      if (subject.index.KeyFrameRow(row, origin) == kNoRow)
        findings.Add(PlaceOf(subject.atlas.maps[row]), "origin ", origin, Absence(subject, origin));
}

std::size_t EraseDanglingOrigins(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t erased = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    erased += std::erase_if(atlas.maps[row].origins,
                            [&](KeyFrameId origin) { return index.KeyFrameRow(row, origin) == kNoRow; });
  return erased;
}

void CheckOriginGiven(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    if (!map.keyframes.empty() && map.origins.empty())
      findings.Add(PlaceOf(map), "has no origin, from which global bundle adjustment spreads");
}

// The initial keyframe, as tracking does it.
std::size_t SetMissingOrigins(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t set = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    Map& map = atlas.maps[row];
    if (!map.origins.empty() || index.KeyFrameRow(row, map.first_keyframe) == kNoRow) continue;
    map.origins.push_back(map.first_keyframe);
    ++set;
  }
  return set;
}

}  // namespace slamdb::detail
