// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/split.h"

#include <algorithm>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/select.h"

namespace slamdb {
namespace {

using detail::Concat;

bool HasAny(const std::vector<std::uint8_t>& flags) { return std::ranges::count(flags, 1) > 0; }

// The part of some keyframes of one map, and the points that they observe.
Subset PartOf(const AtlasIndex& index, const Component& component) {
  Subset subset = Subset::Nothing(index.atlas());
  auto& [keyframes, points, landmarks] = subset.maps[component.map];
  std::ranges::fill(landmarks, std::uint8_t{1});
  for (const std::uint32_t row : component.keyframes) keyframes[row] = 1;
  const Map& map = index.atlas().maps[component.map];
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] =
        std::ranges::any_of(map.points[i].observations, [&, &flags = keyframes](const Observation& observation) {
          const std::uint32_t observer = index.KeyFrameRow(component.map, observation.keyframe);
          return observer != kNoRow && flags[observer] != 0;
        });
  return subset;
}

void AddSessions(const AtlasIndex& index, std::vector<Part>& parts) {
  std::set<std::uint32_t> sessions;
  for (const Map& map : index.atlas().maps)
    for (const KeyFrame& keyframe : map.keyframes) sessions.insert(keyframe.origin_map);
  for (const std::uint32_t session : sessions)
    parts.push_back({Concat("session-", session), Select(index, {.session = session})});
}

void AddMaps(const AtlasIndex& index, std::vector<Part>& parts) {
  const Atlas& atlas = index.atlas();
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    if (map.keyframes.empty() && map.landmarks.empty()) continue;
    Part& part = parts.emplace_back(Part{Concat("map-", map.id.value()), Subset::Nothing(atlas)});
    part.subset.maps[row] = Subset::Everything(atlas).maps[row];
  }
}

void AddComponents(const AtlasIndex& index, std::vector<Part>& parts) {
  for (std::uint32_t row = 0; row < index.atlas().maps.size(); ++row) {
    std::size_t number = 0;
    for (const Component& component : FindComponents(index, row))
      parts.push_back(
          {Concat("map-", index.atlas().maps[row].id.value(), "-component-", ++number), PartOf(index, component)});
  }
}

bool IsSmall(const Part& part, std::size_t min_keyframes) {
  std::size_t keyframes = 0;
  bool has_landmarks = false;
  for (const Subset::MapRows& rows : part.subset.maps) {
    keyframes += static_cast<std::size_t>(std::ranges::count(rows.keyframes, 1));
    has_landmarks = has_landmarks || HasAny(rows.landmarks);
  }
  return keyframes < min_keyframes && (keyframes > 0 || !has_landmarks);
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
  std::erase_if(parts, [&](const Part& part) { return IsSmall(part, options.min_keyframes); });
  if (parts.empty())
    throw Error(ErrorKind::kNotPossible, Concat("has no ", NameOf(options.by), " with ", options.min_keyframes,
                                                options.min_keyframes == 1 ? " keyframe" : " keyframes"));
  detail::Steps steps(options.progress, "splitting", parts.size());
  for (Part& part : parts) {
    SettleBorder(index, options.border, part.subset, options.threads);
    steps.Next();
  }
  return parts;
}

Atlas TakePart(const Atlas& atlas, const Subset& subset, SubsetReport& report, int threads) {
  Atlas part;
  part.vocabulary = atlas.vocabulary;
  part.cameras = atlas.cameras;
  part.next_ids = atlas.next_ids;
  part.encoding = atlas.encoding;
  Subset rows;
  SubsetReport left;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    if (!HasAny(subset.maps.at(row).keyframes) && !HasAny(subset.maps[row].landmarks)) {
      ++left.maps;
      left.landmarks += atlas.maps[row].landmarks.size();
      left.keyframes += atlas.maps[row].keyframes.size();
      left.points += atlas.maps[row].points.size();
      continue;
    }
    part.maps.push_back(atlas.maps[row]);
    rows.maps.push_back(subset.maps[row]);
  }
  report = KeepSubset(part, rows, threads);
  report.before = CountEntities(atlas);
  report.maps += left.maps;
  report.keyframes += left.keyframes;
  report.points += left.points;
  report.landmarks += left.landmarks;
  return part;
}

}  // namespace slamdb
