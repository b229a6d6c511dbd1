// SPDX-License-Identifier: BSD-3-Clause
// Keyframes and points that are flagged bad: culled, but stored all the same.
#include <algorithm>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

// Healthy atlases have no bad elements, and then nothing can refer to one.
bool HasBadKeyFrames(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.bad}; });
  });
}
bool HasBadPoints(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.points, [](const MapPoint& point) { return bool{point.bad}; });
  });
}

}  // namespace

void CheckKeyFrameBad(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes)
      if (keyframe.bad) findings.Add(PlaceOf(map, keyframe), "is flagged bad, but stored");
}

void CheckPointBad(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    for (const MapPoint& point : map.points)
      if (point.bad) findings.Add(PlaceOf(map, point), "is flagged bad, but stored");
}

void CheckBadKeyFrameReferenced(const Subject& subject, Findings& findings) {
  if (!HasBadKeyFrames(subject.atlas)) return;
  const auto is_bad = [&](std::size_t row, KeyFrameId id) {
    const KeyFrame* target = subject.index.FindKeyFrame(row, id);
    return target != nullptr && target->bad;
  };
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const auto report = [&](const char* role, KeyFrameId id) {
      if (is_bad(row, id)) findings.Add(PlaceOf(map, keyframe), role, " ", id, ", which is bad");
    };
    report("parent", keyframe.parent);
    report("previous", keyframe.previous);
    report("next", keyframe.next);
    for (const Connection& connection : keyframe.connections) report("covisible with", connection.keyframe);
    for (const KeyFrameId id : keyframe.children) report("child", id);
    for (const KeyFrameId id : keyframe.loop_edges) report("loop edge to", id);
    for (const KeyFrameId id : keyframe.merge_edges) report("merge edge to", id);
  });
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    if (is_bad(row, point.reference))
      findings.Add(PlaceOf(map, point), "reference keyframe ", point.reference, ", which is bad");
    for (const Observation& observation : point.observations)
      if (is_bad(row, observation.keyframe))
        findings.Add(PlaceOf(map, point), "observed by ", observation.keyframe, ", which is bad");
  });
}

void CheckBadPointReferenced(const Subject& subject, Findings& findings) {
  if (!HasBadPoints(subject.atlas)) return;
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const Column<MapPointId>& slots = keyframe.features.map_points;
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      const MapPoint* point = slots[slot] ? subject.index.FindPoint(row, slots[slot]) : nullptr;
      if (point != nullptr && point->bad)
        findings.Add(PlaceOf(map, keyframe, slot), "sees ", slots[slot], ", which is bad");
    }
  });
}

// What refers to them then leads nowhere: the business of the rules that follow.
std::size_t DropBadKeyFrames(Atlas& atlas) {
  return DropEntities(atlas, &Map::keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.bad}; });
}

std::size_t DropBadPoints(Atlas& atlas) {
  return DropEntities(atlas, &Map::points, [](const MapPoint& point) { return bool{point.bad}; });
}

std::size_t EmptySlotsOfBadPoints(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t emptied = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (KeyFrame& keyframe : atlas.maps[row].keyframes)
      for (MapPointId& slot : keyframe.features.map_points) {
        const MapPoint* point = slot ? index.FindPoint(row, slot) : nullptr;
        if (point == nullptr || !point->bad) continue;
        slot = MapPointId();
        ++emptied;
      }
  return emptied;
}

}  // namespace slamdb::detail
