// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/split.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/gaps.h"
#include "slamdb/edit/part/select.h"
#include "slamdb/model/detail/irregular_entries.h"

namespace slamdb {
namespace {

using detail::Concat;

// Sessions go through several maps.
void AddSessions(const AtlasIndex& index, std::vector<Part>& parts) {
  std::map<std::uint32_t, std::vector<Part::OfMap>> sessions;
  const Atlas& atlas = index.atlas();
  for (std::uint32_t map = 0; map < atlas.maps.size(); ++map) {
    for (std::uint32_t row = 0; row < atlas.maps[map].keyframes.size(); ++row) {
      std::vector<Part::OfMap>& session = sessions[atlas.maps[map].keyframes[row].origin_map];
      if (session.empty() || session.back().map != map) session.push_back({map, {}, {}});
      session.back().keyframes.push_back(row);
    }
  }
  for (auto& [session, maps] : sessions) parts.push_back({Concat("session-", session), std::move(maps), {}});
}

void AddMaps(const AtlasIndex& index, std::vector<Part>& parts) {
  const Atlas& atlas = index.atlas();
  for (std::uint32_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    if (map.keyframes.empty() && map.landmarks.empty()) continue;
    std::vector<std::uint32_t> keyframes(map.keyframes.size());
    std::iota(keyframes.begin(), keyframes.end(), 0U);
    parts.push_back({Concat("map-", map.id.value()), {{row, std::move(keyframes), {}}}, {}});
  }
}

void AddComponents(const AtlasIndex& index, std::vector<Part>& parts) {
  for (std::uint32_t row = 0; row < index.atlas().maps.size(); ++row) {
    std::size_t number = 0;
    for (Component& component : FindComponents(index, row))
      parts.push_back({Concat("map-", index.atlas().maps[row].id.value(), "-component-", ++number),
                       {{row, std::move(component.keyframes), {}}},
                       {}});
  }
}

// The points of each part, by one pass over all observations.
void AddPoints(const AtlasIndex& index, std::vector<Part>& parts) {
  const Atlas& atlas = index.atlas();
  std::vector<std::vector<Part::OfMap*>> takers;  // of the keyframes of each map; null: none
  for (const Map& map : atlas.maps) takers.emplace_back(map.keyframes.size(), nullptr);
  for (Part& part : parts)
    for (Part::OfMap& of : part.maps)
      for (const std::uint32_t row : of.keyframes) takers[of.map][row] = &of;
  for (std::uint32_t map = 0; map < atlas.maps.size(); ++map)
    for (std::uint32_t row = 0; row < atlas.maps[map].points.size(); ++row)
      for (const Observation& observation : atlas.maps[map].points[row].observations) {
        const std::uint32_t observer = index.KeyFrameRow(map, observation.keyframe);
        Part::OfMap* taker = observer == kNoRow ? nullptr : takers[map][observer];
        if (taker != nullptr && (taker->points.empty() || taker->points.back() != row)) taker->points.push_back(row);
      }
}

bool IsSmall(const Atlas& atlas, const Part& part, std::size_t min_keyframes) {
  std::size_t keyframes = 0;
  bool has_landmarks = false;
  for (const Part::OfMap& of : part.maps) {
    keyframes += of.keyframes.size();
    has_landmarks = has_landmarks || !atlas.maps[of.map].landmarks.empty();
  }
  return keyframes < min_keyframes && (keyframes > 0 || !has_landmarks);
}

void RequireOfAtlas(const Atlas& atlas, const Part& part) {
  const auto exceed = [](const std::vector<std::uint32_t>& rows, std::size_t size) {
    return !rows.empty() && std::ranges::max(rows) >= size;
  };
  for (const Part::OfMap& of : part.maps)
    if (of.map >= atlas.maps.size() || exceed(of.keyframes, atlas.maps[of.map].keyframes.size()) ||
        exceed(of.points, atlas.maps[of.map].points.size()))
      throw Error(ErrorKind::kUsage, Concat("the part ", part.name, " is not of this atlas"));
}

// What a part takes of one map, with its border settled.
Subset::MapRows RowsOf(const AtlasIndex& index, const Part::OfMap& of, Border border, int threads) {
  const Map& map = index.atlas().maps[of.map];
  Subset::MapRows rows{.keyframes = std::vector<std::uint8_t>(map.keyframes.size(), 0),
                       .points = std::vector<std::uint8_t>(map.points.size(), 0),
                       .landmarks = std::vector<std::uint8_t>(map.landmarks.size(), 1)};
  for (const std::uint32_t row : of.keyframes) rows.keyframes[row] = 1;
  for (const std::uint32_t row : of.points) rows.points[row] = 1;
  SettleBorder(index, of.map, border, rows, threads);
  return rows;
}

bool HasAll(const std::vector<std::uint8_t>& rows) { return std::ranges::find(rows, 0) == rows.end(); }

// The rows to copy of those to keep: also the keyframes in time between two that are kept, whose preintegrations
// KeepSubset joins.
std::vector<std::uint8_t> WithBridges(const AtlasIndex& index, std::uint32_t map_row,
                                      const std::vector<std::uint8_t>& kept) {
  const Map& map = index.atlas().maps[map_row];
  std::vector<std::uint8_t> rows = kept;
  std::vector<std::uint32_t> between;
  const auto row_of = [&](KeyFrameId id) { return index.KeyFrameRow(map_row, id); };
  for (std::uint32_t row = 0; row < kept.size(); ++row)
    if (kept[row] && detail::KeptBefore(map, kept, row, row_of, between) != kNoRow)
      for (const std::uint32_t bridge : between) rows[bridge] = 1;
  return rows;
}

template <class Entity>
Column<Entity> Copied(const Column<Entity>& list, const std::vector<std::uint8_t>& rows) {
  Column<Entity> copy;
  copy.reserve(static_cast<std::size_t>(std::ranges::count(rows, 1)));
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (rows[row]) copy.push_back(list[row]);
  return copy;
}

// A copy of a map with no more of its lists than is needed to keep `rows`, which become rows of the copy.
Map CopyFor(const AtlasIndex& index, std::uint32_t map_row, Subset::MapRows& rows) {
  const Map& map = index.atlas().maps[map_row];
  const std::vector<std::uint8_t> copied = WithBridges(index, map_row, rows.keyframes);
  Map copy{.id = map.id,
           .initial_keyframe = map.initial_keyframe,
           .max_keyframe_id = map.max_keyframe_id,
           .big_change_index = map.big_change_index,
           .keyframes = Copied(map.keyframes, copied),
           .points = Copied(map.points, rows.points),
           .repeated_keyframes = {},
           .repeated_points = {},
           .landmarks = map.landmarks,
           .origins = map.origins,
           .first_keyframe = map.first_keyframe,
           .lowest_keyframe = map.lowest_keyframe,
           .imu_initialized = map.imu_initialized,
           .inertial = map.inertial,
           .imu_ba1 = map.imu_ba1,
           .imu_ba2 = map.imu_ba2};
  std::size_t row = 0;
  std::erase_if(rows.keyframes, [&](std::uint8_t) { return copied[row++] == 0; });
  rows.points.assign(copy.points.size(), 1);
  return copy;
}

bool Uses(const Map& map, CameraId camera) {
  return std::ranges::any_of(map.keyframes, [&](const KeyFrame& keyframe) {
    return keyframe.camera == camera || keyframe.right_camera == camera;
  });
}

// Cameras that the part's maps used and the part does not.
std::size_t DropUnusedCameras(const Atlas& atlas, const Part& part, Atlas& own) {
  return std::erase_if(own.cameras, [&](const Camera& camera) {
    return std::ranges::none_of(own.maps, [&](const Map& map) { return Uses(map, camera.id); }) &&
           std::ranges::any_of(part.maps, [&](const Part::OfMap& of) { return Uses(atlas.maps[of.map], camera.id); });
  });
}

std::string_view NameOf(SplitBy by) {
  return by == SplitBy::kMap ? "map" : by == SplitBy::kSession ? "session" : "component";
}

}  // namespace

std::vector<Part> SplitAtlas(const AtlasIndex& index, const SplitOptions& options) {
  std::vector<Part> parts;
  if (options.by == SplitBy::kSession) AddSessions(index, parts);
  if (options.by == SplitBy::kMap) AddMaps(index, parts);
  if (options.by == SplitBy::kComponent) AddComponents(index, parts);
  std::erase_if(parts, [&](const Part& part) { return IsSmall(index.atlas(), part, options.min_keyframes); });
  if (parts.empty())
    throw Error(ErrorKind::kNotPossible, Concat("has no ", NameOf(options.by), " with ", options.min_keyframes,
                                                options.min_keyframes == 1 ? " keyframe" : " keyframes"));
  AddPoints(index, parts);
  const EntityCounts counts = CountEntities(index.atlas());
  for (Part& part : parts) part.of_atlas = counts;
  return parts;
}

Atlas TakePart(const AtlasIndex& index, const Part& part, Border border, SubsetReport& report, int threads) {
  const Atlas& atlas = index.atlas();
  RequireOfAtlas(atlas, part);
  Atlas own;
  own.vocabulary = atlas.vocabulary;
  own.cameras = atlas.cameras;
  own.next_ids = atlas.next_ids;
  own.encoding = atlas.encoding;
  own.layout = atlas.layout;
  own.carried = atlas.carried;
  Subset subset;
  bool whole = part.maps.size() == atlas.maps.size();
  for (const Part::OfMap& of : part.maps) {
    Subset::MapRows rows = RowsOf(index, of, border, threads);
    const bool whole_map = HasAll(rows.keyframes) && HasAll(rows.points);
    own.maps.push_back(whole_map ? atlas.maps[of.map] : CopyFor(index, of.map, rows));
    subset.maps.push_back(std::move(rows));
    whole = whole && whole_map;
  }
  report = KeepSubset(own, subset, threads);
  if (!whole) detail::DropIrregularEntries(own);
  report.cameras += DropUnusedCameras(atlas, part, own);
  const EntityCounts copied = report.before;
  report.before = part.of_atlas;
  report.maps += report.before.maps - copied.maps;
  report.keyframes += report.before.keyframes - copied.keyframes;
  report.points += report.before.points - copied.points;
  report.landmarks += report.before.landmarks - copied.landmarks;
  return own;
}

}  // namespace slamdb
