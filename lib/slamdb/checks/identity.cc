// SPDX-License-Identifier: BSD-3-Clause
// Lists, ids and counters: what must be there once, and what the next id must be.
#include <algorithm>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/content.h"
#include "slamdb/model/counters.h"

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kLargestKeyFrameId = (std::uint64_t{1} << 31) - 1;

template <class Visit>
void ForEachRepeatedList(const Atlas& atlas, const Visit& visit) {
  visit("map", Place{}, atlas.repeated_maps);
  visit("camera", Place{}, atlas.repeated_cameras);
  for (const Map& map : atlas.maps) {
    visit("keyframe", PlaceOf(map), map.repeated_keyframes);
    visit("point", PlaceOf(map), map.repeated_points);
  }
}

template <class Visit>
void ForEachRepeatedList(Atlas& atlas, const Visit& visit) {
  visit(atlas.repeated_maps);
  visit(atlas.repeated_cameras);
  for (Map& map : atlas.maps) {
    visit(map.repeated_keyframes);
    visit(map.repeated_points);
  }
}

// Takes entries out of the list of `kept` objects and the irregular `entries` between them, and moves the positions of
// the others up.
template <class Drop>
std::size_t DropEntries(std::vector<RepeatedEntry>& entries, const Drop& drop) {
  std::vector<RepeatedEntry> kept;
  std::uint64_t dropped = 0;
  for (const RepeatedEntry& entry : entries) {
    if (drop(entry)) {
      ++dropped;
    } else {
      kept.push_back(entry);
      kept.back().position -= std::min(dropped, entry.position);
    }
  }
  if (dropped > 0) entries = std::move(kept);
  return dropped;
}

bool IsNull(const RepeatedEntry& entry) { return entry.owner_map == RepeatedEntry::kNull; }

template <class Entity>
void ReportDuplicates(const Subject& subject, std::span<const DuplicateId> duplicates, bool same_map,
                      const Entity& place_of, Findings& findings) {
  for (const DuplicateId& duplicate : duplicates) {
    if ((duplicate.again.map == duplicate.first.map) != same_map) continue;
    const auto& maps = subject.atlas.maps;
    if (same_map)
      findings.Add(place_of(duplicate.again), "entries ", duplicate.first.row, " and ", duplicate.again.row,
                   " of the map's list have this id");
    else
      findings.Add(place_of(duplicate.again), "has the id of another one in ", maps[duplicate.first.map].id);
  }
}

void ReportDuplicateKeyFrames(const Subject& subject, bool same_map, Findings& findings) {
  const auto place_of = [&](const EntityRow& at) {
    return PlaceOf(subject.atlas.maps[at.map], subject.atlas.maps[at.map].keyframes[at.row]);
  };
  ReportDuplicates(subject, subject.index.duplicate_keyframes(), same_map, place_of, findings);
}

void ReportDuplicatePoints(const Subject& subject, bool same_map, Findings& findings) {
  const auto place_of = [&](const EntityRow& at) {
    return PlaceOf(subject.atlas.maps[at.map], subject.atlas.maps[at.map].points[at.row]);
  };
  ReportDuplicates(subject, subject.index.duplicate_points(), same_map, place_of, findings);
}

struct CounterField {
  const char* kind;
  std::uint64_t Counters::*next;
};
constexpr CounterField kCounters[] = {{"map", &Counters::map},
                                      {"frame", &Counters::frame},
                                      {"keyframe", &Counters::keyframe},
                                      {"point", &Counters::map_point},
                                      {"camera", &Counters::camera}};

std::uint64_t LargestKeyFrameId(const Map& map) {
  std::uint64_t largest = 0;
  for (const KeyFrame& keyframe : map.keyframes)
    if (keyframe.id) largest = std::max(largest, keyframe.id.value());
  return largest;
}

bool IsLeftover(const Map& map) {
  return map.keyframes.empty() && map.points.empty() && map.landmarks.empty() && map.repeated_keyframes.empty() &&
         map.repeated_points.empty();
}

}  // namespace

void CheckListEntryNull(const Subject& subject, Findings& findings) {
  ForEachRepeatedList(subject.atlas, [&](const char* kind, const Place& place, const auto& entries) {
    for (const RepeatedEntry& entry : entries)
      if (IsNull(entry)) findings.Add(place, "entry ", entry.position, " of the ", kind, " list is a null pointer");
  });
}

std::size_t DropNullEntries(Atlas& atlas) {
  std::size_t dropped = 0;
  ForEachRepeatedList(atlas, [&](std::vector<RepeatedEntry>& entries) { dropped += DropEntries(entries, IsNull); });
  return dropped;
}

void CheckMapListedOnce(const Subject& subject, Findings& findings) {
  for (const RepeatedEntry& entry : subject.atlas.repeated_maps) {
    if (IsNull(entry)) continue;
    const auto& maps = subject.atlas.maps;
    findings.Add(entry.row < maps.size() ? PlaceOf(maps[entry.row]) : Place{}, "entry ", entry.position,
                 " of the map list is this map again");
  }
}

std::size_t DropRepeatedMaps(Atlas& atlas) {
  return DropEntries(atlas.repeated_maps, [](const RepeatedEntry& entry) { return !IsNull(entry); });
}

void CheckListedInOneMap(const Subject& subject, Findings& findings) {
  const auto& maps = subject.atlas.maps;
  const auto report = [&](std::size_t map, const char* kind, const std::vector<RepeatedEntry>& entries) {
    for (const RepeatedEntry& entry : entries) {
      if (IsNull(entry) || entry.owner_map == map) continue;
      findings.Add(PlaceOf(maps[map]), "entry ", entry.position, " of the ", kind, " list belongs to ", [&] {
        return entry.owner_map < maps.size() ? ToString(maps[entry.owner_map].id) : std::string("another map");
      });
    }
  };
  for (std::size_t map = 0; map < maps.size(); ++map) {
    report(map, "keyframe", maps[map].repeated_keyframes);
    report(map, "point", maps[map].repeated_points);
  }
}

std::size_t DropEntriesOfOtherMaps(Atlas& atlas) {
  std::size_t dropped = 0;
  for (std::size_t map = 0; map < atlas.maps.size(); ++map) {
    const auto of_other = [&](const RepeatedEntry& entry) { return !IsNull(entry) && entry.owner_map != map; };
    dropped += DropEntries(atlas.maps[map].repeated_keyframes, of_other);
    dropped += DropEntries(atlas.maps[map].repeated_points, of_other);
  }
  return dropped;
}

void CheckListedOnce(const Subject& subject, Findings& findings) {
  const auto& maps = subject.atlas.maps;
  for (const RepeatedEntry& entry : subject.atlas.repeated_cameras)
    if (!IsNull(entry)) findings.Add(Place{}, "entry ", entry.position, " of the camera list repeats an earlier one");
  for (std::size_t map = 0; map < maps.size(); ++map) {
    for (const RepeatedEntry& entry : maps[map].repeated_keyframes)
      if (entry.owner_map == map)
        findings.Add(PlaceOf(maps[map]), "entry ", entry.position, " of the keyframe list repeats an earlier one");
    for (const RepeatedEntry& entry : maps[map].repeated_points)
      if (entry.owner_map == map)
        findings.Add(PlaceOf(maps[map]), "entry ", entry.position, " of the point list repeats an earlier one");
  }
}

std::size_t DropRepeatedEntries(Atlas& atlas) {
  std::size_t dropped = DropEntries(atlas.repeated_cameras, [](const RepeatedEntry& entry) { return !IsNull(entry); });
  for (std::size_t map = 0; map < atlas.maps.size(); ++map) {
    const auto of_this_map = [&](const RepeatedEntry& entry) { return entry.owner_map == map; };
    dropped += DropEntries(atlas.maps[map].repeated_keyframes, of_this_map);
    dropped += DropEntries(atlas.maps[map].repeated_points, of_this_map);
  }
  return dropped;
}

void CheckMapEmpty(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    if (map.keyframes.empty() && map.landmarks.empty())
      findings.Add(PlaceOf(map), "has no keyframes and ", map.points.size(), " points");
}

void CheckAtlasEmpty(const Subject& subject, Findings& findings) {
  const std::string_view lacks = SubstanceOf(subject.atlas).Lacks();
  if (lacks.empty()) return;
  const AtlasStatistics& all = subject.statistics;
  const bool flagged = (lacks == "keyframes" && all.keyframes > 0) || (lacks == "points" && all.points > 0);
  findings.Add(Place{}, "has no ", lacks, flagged ? " but such as are flagged bad" : "",
               ": there is nothing to localise in");
}

// Only maps in which nothing is left: points without keyframes are data, which a repair does not throw away. Rows of
// maps that other lists name move up.
std::size_t DropEmptyMaps(Atlas& atlas) {
  std::vector<std::uint32_t> new_rows(atlas.maps.size(), kNoRow);
  std::vector<std::uint64_t> dropped_positions;
  std::uint32_t kept = 0;
  std::uint64_t position = 0;
  auto irregular = atlas.repeated_maps.begin();
  for (std::size_t row = 0; row < atlas.maps.size(); ++row, ++position) {
    for (; irregular != atlas.repeated_maps.end() && irregular->position <= position; ++irregular) ++position;
    if (IsLeftover(atlas.maps[row]))
      dropped_positions.push_back(position);
    else
      new_rows[row] = kept++;
  }
  if (dropped_positions.empty()) return 0;

  std::vector<RepeatedEntry> entries;
  for (RepeatedEntry entry : atlas.repeated_maps) {
    const auto gone = static_cast<std::uint64_t>(std::ranges::lower_bound(dropped_positions, entry.position) -
                                                 dropped_positions.begin());
    const bool repeats_map = !IsNull(entry) && entry.row < new_rows.size();
    if (repeats_map && new_rows[entry.row] == kNoRow) {
      dropped_positions.insert(std::ranges::lower_bound(dropped_positions, entry.position), entry.position);
      continue;
    }
    if (repeats_map) entry.row = new_rows[entry.row];
    entry.position -= gone;
    entries.push_back(entry);
  }
  atlas.repeated_maps = std::move(entries);
  for (Map& map : atlas.maps)
    for (auto* list : {&map.repeated_keyframes, &map.repeated_points})
      for (RepeatedEntry& entry : *list)
        if (entry.owner_map < new_rows.size()) entry.owner_map = new_rows[entry.owner_map];
  return std::erase_if(atlas.maps, IsLeftover);
}

void CheckMapIdUnique(const Subject& subject, Findings& findings) {
  for (const DuplicateId& duplicate : subject.index.duplicate_maps())
    findings.Add(PlaceOf(subject.atlas.maps[duplicate.again.row]), "maps ", duplicate.first.row, " and ",
                 duplicate.again.row, " of the list have this id");
}

// The later ones get the next ids. In which map keyframes were made stays as recorded.
std::size_t RenumberRepeatedMaps(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::uint64_t& next = atlas.next_ids.map;
  if (!index.duplicate_maps().empty()) next = std::max(next, LeastCounters(atlas).map);
  for (const DuplicateId& duplicate : index.duplicate_maps()) atlas.maps[duplicate.again.row].id = MapId(next++);
  return index.duplicate_maps().size();
}

void CheckCameraIdUnique(const Subject& subject, Findings& findings) {
  for (const DuplicateId& duplicate : subject.index.duplicate_cameras())
    findings.Add(Place{.camera = subject.atlas.cameras[duplicate.again.row].id}, "cameras ", duplicate.first.row,
                 " and ", duplicate.again.row, " of the list have this id");
}

// Only those that are the same camera again.
std::size_t DropRepeatedCameras(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::vector<std::uint8_t> is_dropped(atlas.cameras.size(), 0);
  for (const DuplicateId& duplicate : index.duplicate_cameras()) {
    const Camera &again = atlas.cameras[duplicate.again.row], &first = atlas.cameras[duplicate.first.row];
    is_dropped[duplicate.again.row] = again.model == first.model && again.recorded_type == first.recorded_type &&
                                      again.parameters == first.parameters && again.precision == first.precision;
  }
  if (std::ranges::find(is_dropped, 1) == is_dropped.end()) return 0;
  std::size_t dropped = DropNullEntries(atlas) + DropRepeatedEntries(atlas);
  for (std::size_t row = is_dropped.size(); row-- > 0;) {
    if (is_dropped[row] == 0) continue;
    atlas.cameras.erase(atlas.cameras.begin() + static_cast<std::ptrdiff_t>(row));
    ++dropped;
  }
  return dropped;
}

void CheckKeyFrameIdUnique(const Subject& subject, Findings& findings) {
  ReportDuplicateKeyFrames(subject, true, findings);
}

void CheckPointIdUnique(const Subject& subject, Findings& findings) { ReportDuplicatePoints(subject, true, findings); }

void CheckKeyFrameIdUniqueInAtlas(const Subject& subject, Findings& findings) {
  ReportDuplicateKeyFrames(subject, false, findings);
}

void CheckPointIdUniqueInAtlas(const Subject& subject, Findings& findings) {
  ReportDuplicatePoints(subject, false, findings);
}

void CheckKeyFrameIdRange(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes)
      if (keyframe.id.value() > kLargestKeyFrameId)
        findings.Add(PlaceOf(map, keyframe), "keyframe id ", keyframe.id.value(), " is not below 2^31");
}

void CheckMaxKeyFrameId(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps)
    if (const std::uint64_t largest = LargestKeyFrameId(map); largest > map.max_keyframe_id)
      findings.Add(PlaceOf(map), "the largest keyframe id is recorded as ", map.max_keyframe_id, ", but it is ",
                   largest);
}

std::size_t RaiseMaxKeyFrameIds(Atlas& atlas) {
  std::size_t raised = 0;
  for (Map& map : atlas.maps) {
    const std::uint64_t largest = LargestKeyFrameId(map);
    if (largest <= map.max_keyframe_id) continue;
    map.max_keyframe_id = largest;
    ++raised;
  }
  return raised;
}

void CheckCountersAboveIds(const Subject& subject, Findings& findings) {
  const Counters least = LeastCounters(subject.atlas);
  for (const CounterField& field : kCounters)
    if (subject.atlas.next_ids.*field.next < least.*field.next)
      findings.Add(Place{}, "the next ", field.kind, " id is ", subject.atlas.next_ids.*field.next, ", but ids up to ",
                   least.*field.next - 1, " are taken");
}

void CheckOriginMapId(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (keyframe.origin_map >= subject.atlas.next_ids.map)
      findings.Add(PlaceOf(map, keyframe), "was made in map ", keyframe.origin_map, ", but the next map id is ",
                   subject.atlas.next_ids.map);
  });
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (point.origin_map != MapPoint::kNoOrigin && point.origin_map >= subject.atlas.next_ids.map)
      findings.Add(PlaceOf(map, point), "was made in map ", point.origin_map, ", but the next map id is ",
                   subject.atlas.next_ids.map);
  });
}

void CheckVocabularyChecksum(const Subject& subject, Findings& findings) {
  const auto& [name, checksum] = subject.atlas.vocabulary;
  const bool hexadecimal = std::ranges::all_of(
      checksum, [](char digit) { return (digit >= '0' && digit <= '9') || (digit >= 'a' && digit <= 'f'); });
  // ORB-SLAM3 never sees atlases of landmarks alone, which have no bags of words; its own always name a vocabulary.
  const std::vector<Map>& maps = subject.atlas.maps;
  const bool has_words =
      maps.empty() || std::ranges::any_of(maps, [](const Map& map) { return !map.keyframes.empty(); });
  if (name.empty() && checksum.empty() && !has_words) return;
  if (checksum.empty())
    findings.Add(Place{}, "the vocabulary's checksum is empty");
  else if (checksum.size() != 32 || !hexadecimal)
    findings.Add(Place{}, "the vocabulary's checksum is not an MD5 in 32 lower-case hex digits");
}

}  // namespace slamdb::detail
