// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/split.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/select.h"

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
      if (session.empty() || session.back().map != map) session.push_back({map, {}});
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
    parts.push_back({Concat("map-", map.id.value()), {{row, std::move(keyframes)}}, {}});
  }
}

void AddComponents(const AtlasIndex& index, std::vector<Part>& parts) {
  for (std::uint32_t row = 0; row < index.atlas().maps.size(); ++row) {
    std::size_t number = 0;
    for (Component& component : FindComponents(index, row))
      parts.push_back({Concat("map-", index.atlas().maps[row].id.value(), "-component-", ++number),
                       {{row, std::move(component.keyframes)}},
                       {}});
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
  for (const Part::OfMap& of : part.maps)
    if (of.map >= atlas.maps.size() ||
        (!of.keyframes.empty() && std::ranges::max(of.keyframes) >= atlas.maps[of.map].keyframes.size()))
      throw Error(ErrorKind::kUsage, Concat("the part ", part.name, " is not of this atlas"));
}

// What a part takes of one map, with its border settled.
Subset::MapRows RowsOf(const AtlasIndex& index, const Part::OfMap& of, Border border, int threads) {
  const Map& map = index.atlas().maps[of.map];
  Subset::MapRows rows{.keyframes = std::vector<std::uint8_t>(map.keyframes.size(), 0),
                       .points = std::vector<std::uint8_t>(map.points.size(), 0),
                       .landmarks = std::vector<std::uint8_t>(map.landmarks.size(), 1)};
  for (const std::uint32_t row : of.keyframes) rows.keyframes[row] = 1;
  for (std::size_t i = 0; i < map.points.size(); ++i)
    rows.points[i] = std::ranges::any_of(map.points[i].observations, [&](const Observation& observation) {
      const std::uint32_t observer = index.KeyFrameRow(of.map, observation.keyframe);
      return observer != kNoRow && rows.keyframes[observer] != 0;
    });
  SettleBorder(index, of.map, border, rows, threads);
  return rows;
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
  Subset subset;
  for (const Part::OfMap& of : part.maps) {
    own.maps.push_back(atlas.maps[of.map]);
    subset.maps.push_back(RowsOf(index, of, border, threads));
  }
  report = KeepSubset(own, subset, threads);
  const EntityCounts copied = report.before;
  report.before = part.of_atlas;
  report.maps += report.before.maps - copied.maps;
  report.keyframes += report.before.keyframes - copied.keyframes;
  report.points += report.before.points - copied.points;
  report.landmarks += report.before.landmarks - copied.landmarks;
  return own;
}

}  // namespace slamdb
