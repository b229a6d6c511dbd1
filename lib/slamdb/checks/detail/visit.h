// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "slamdb/checks/detail/catalogue.h"

// How rules go through an atlas and name what they find. Private to the rules.
namespace slamdb::detail {

inline Place PlaceOf(const Map& map) { return {.map = map.id}; }
inline Place PlaceOf(const Map& map, const KeyFrame& keyframe) { return {.map = map.id, .keyframe = keyframe.id}; }
inline Place PlaceOf(const Map& map, const KeyFrame& keyframe, std::size_t feature) {
  return {.map = map.id, .keyframe = keyframe.id, .feature = static_cast<std::int64_t>(feature)};
}
inline Place PlaceOf(const Map& map, const MapPoint& point) { return {.map = map.id, .point = point.id}; }

// How many rows of features have a descriptor; of a matrix that says more than it has, as many as it could have.
inline std::size_t DescriptorRows(const KeyFrame& keyframe) {
  const std::size_t rows = keyframe.descriptor_count();
  return keyframe.carried
             ? std::min(rows, keyframe.features.descriptors.size() + keyframe.carried->descriptors.data.size())
             : rows;
}

// visit(map row, map, keyframe) for every keyframe that is not bad. Bad ones are a finding of `keyframe-bad`, and what
// they hold is not used.
template <class Visit>
void ForEachKeyFrame(const Atlas& atlas, const Visit& visit) {
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (const KeyFrame& keyframe : atlas.maps[row].keyframes)
      if (!keyframe.bad) visit(row, atlas.maps[row], keyframe);
}

// visit(map row, map, point) for every point that is not bad; likewise.
template <class Visit>
void ForEachPoint(const Atlas& atlas, const Visit& visit) {
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (const MapPoint& point : atlas.maps[row].points)
      if (!point.bad) visit(row, atlas.maps[row], point);
}

// visit(map row, map, point, observation, observing keyframe) for every observation by a keyframe of the map.
template <class Visit>
void ForEachObservation(const Subject& subject, const Visit& visit) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    for (const Observation& observation : point.observations)
      if (const KeyFrame* keyframe = subject.index.FindKeyFrame(row, observation.keyframe); keyframe != nullptr)
        visit(row, map, point, observation, *keyframe);
  });
}

// Takes the entities that `is_dropped` tells out of a list of every map. Rows move up, and irregular entries of lists
// name rows: those, breaches of other rules, go first. Returns how much went.
template <class Entity, class IsDropped>
std::size_t DropEntities(Atlas& atlas, Column<Entity> Map::*list, const IsDropped& is_dropped) {
  const auto has_any = [&](const Map& map) { return std::ranges::any_of(map.*list, is_dropped); };
  if (std::ranges::none_of(atlas.maps, has_any)) return 0;
  std::size_t dropped = DropNullEntries(atlas) + DropEntriesOfOtherMaps(atlas) + DropRepeatedEntries(atlas);
  for (Map& map : atlas.maps) dropped += std::erase_if(map.*list, is_dropped);
  return dropped;
}

// The same of points, with the slots that hold them.
template <class IsDropped>
std::size_t DropPoints(Atlas& atlas, const IsDropped& is_dropped) {
  const std::size_t dropped = DropEntities(atlas, &Map::points, is_dropped);
  return dropped == 0 ? 0 : dropped + EmptyDanglingSlots(atlas) + ClearDanglingReplacements(atlas);
}

// Why an id is not in a map: ", which does not exist" or ", which is in map 1". A function, for Findings::Add.
inline auto Absence(const Subject& subject, KeyFrameId id) {
  return [&subject, id]() -> std::string {
    const EntityRow found = subject.index.LocateKeyFrame(id);
    return found ? ", which is in " + ToString(subject.atlas.maps[found.map].id) : ", which does not exist";
  };
}
inline auto Absence(const Subject& subject, MapPointId id) {
  return [&subject, id]() -> std::string {
    const EntityRow found = subject.index.LocatePoint(id);
    return found ? ", which is in " + ToString(subject.atlas.maps[found.map].id) : ", which does not exist";
  };
}

// The rows that a left index of an observation may have.
inline std::int32_t LeftRows(const Features& features) {
  return features.is_fisheye_stereo() ? features.left_count : features.count;
}

// Whether an observation's rows are in the keyframe's features: left ones in the left part, right ones behind it.
inline bool LeftRowFits(const Features& features, const Observation& observation) {
  return observation.left >= 0 && observation.left < LeftRows(features);
}
inline bool RightRowFits(const Features& features, const Observation& observation) {
  return features.is_fisheye_stereo() && observation.right >= features.left_count && observation.right < features.count;
}

// The point in a slot of a keyframe, or none when the slot is empty or outside the column.
inline MapPointId SlotPoint(const Features& features, std::int64_t row) {
  return row >= 0 && row < static_cast<std::int64_t>(features.map_points.size())
             ? features.map_points[static_cast<std::size_t>(row)]
             : MapPointId();
}

}  // namespace slamdb::detail
