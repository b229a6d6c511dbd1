// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/prepared_map.h"

#include <algorithm>

#include "slamdb/align/detail/candidates.h"

namespace slamdb::detail {
namespace {

std::deque<MapViews> ViewsOf(std::span<const MapRef> maps, int threads) {
  std::deque<MapViews> views;
  for (const MapRef& map : maps) views.emplace_back(*map.atlas, map.map, threads);
  return views;
}

std::vector<const MapViews*> PointersTo(const std::deque<MapViews>& views) {
  std::vector<const MapViews*> pointers;
  for (const MapViews& each : views) pointers.push_back(&each);
  return pointers;
}

CommonWords WordsOf(std::span<const MapRef> maps, const std::deque<MapViews>& views, const AlignOptions& options) {
  const std::string& checksum = maps.front().atlas->vocabulary.checksum;
  const bool same = !options.own_vocabulary && !checksum.empty() && std::ranges::all_of(maps, [&](const MapRef& map) {
    return map.atlas->vocabulary.checksum == checksum;
  });
  return {PointersTo(views), same, options.threads};
}

}  // namespace

PreparedMaps::PreparedMaps(std::span<const MapRef> maps, const AlignOptions& options)
    : PreparedMaps(maps, options, Recognition::kByWords) {}

PreparedMaps PreparedMaps::WithoutWords(std::span<const MapRef> maps, int threads) {
  return {maps, {.threads = threads, .progress = {}}, Recognition::kNone};
}

PreparedMaps::PreparedMaps(std::span<const MapRef> maps, const AlignOptions& options, Recognition recognition)
    : views_(ViewsOf(maps, options.threads)),
      words_(recognition == Recognition::kByWords ? WordsOf(maps, views_, options) : CommonWords(PointersTo(views_))) {
  for (std::size_t map = 0; map < maps.size(); ++map)
    maps_.push_back({views_[map], words_.Bags(map), NodeTable(views_[map], words_, map),
                     CovisibilityGroups(views_[map], options.threads), PlaceIndex(words_.Bags(map))});
}

}  // namespace slamdb::detail
