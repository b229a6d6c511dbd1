// SPDX-License-Identifier: BSD-3-Clause
// 1. Every pair of maps is aligned.
// 2. Links are taken in the order of how sure they are. Those whose scale is known come first: one by way of a
// monocular
//    map would leave two metric maps with different scales.
// 3. What cycles are off by is spread over their links.
#include "slamdb/align/align_all.h"

#include <algorithm>

#include "slamdb/align/detail/align_pair.h"
#include "slamdb/align/detail/group_maps.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/align/detail/settle_places.h"

namespace slamdb {
namespace {

// The first `asked` maps with all behind them. Progress is told over all pairs.
std::vector<MapLink> LinkAll(const detail::PreparedMaps& maps, std::size_t asked, const AlignOptions& options) {
  std::vector<MapLink> links;
  const auto pairs = static_cast<double>(asked * maps.size() - asked * (asked + 1) / 2);
  AlignOptions of_pair = options;
  if (options.progress)
    of_pair.progress = [&](std::string_view stage, double fraction) {
      options.progress(stage, (static_cast<double>(links.size()) + fraction) / pairs);
    };
  for (std::size_t first = 0; first < asked; ++first)
    for (std::size_t second = first + 1; second < maps.size(); ++second)
      links.push_back({first, second, detail::AlignPair(maps[first], maps[second], maps.trained_words(), of_pair)});
  return links;
}

}  // namespace

std::string_view NameOf(LinkUse use) {
  switch (use) {
    case LinkUse::kJoins:
      return "joins";
    case LinkUse::kCloses:
      return "closes";
    case LinkUse::kContradicts:
      return "contradicts";
    case LinkUse::kUnused:
      return "unused";
  }
  return {};
}

AlignedMaps AlignAllMaps(std::span<const MapRef> maps, const AlignOptions& options) {
  return AlignWithOthers(maps, maps.size(), options);
}

AlignedMaps AlignWithOthers(std::span<const MapRef> maps, std::size_t asked, const AlignOptions& options) {
  AlignedMaps aligned;
  for (std::size_t map = 0; map < maps.size(); ++map) aligned.places.push_back({map, {}});
  if (maps.size() < 2) return aligned;
  const detail::PreparedMaps prepared(maps, options);
  aligned.links = LinkAll(prepared, std::min(asked, maps.size()), options);
  std::vector<detail::MapTraits> traits;
  for (std::size_t map = 0; map < maps.size(); ++map)
    traits.push_back({prepared[map].views.metric(), prepared[map].views.median_depth()});
  const auto knows_scale = [&](const MapLink& link) { return traits[link.first].metric && traits[link.second].metric; };
  std::ranges::stable_sort(aligned.links, [&](const MapLink& a, const MapLink& b) {
    if (a.alignment.verdict != b.alignment.verdict) return a.alignment.verdict < b.alignment.verdict;
    if (knows_scale(a) != knows_scale(b)) return knows_scale(a);
    return a.alignment.evidence.points > b.alignment.evidence.points;
  });
  aligned.places = detail::GroupMaps(aligned.links, traits);
  detail::SettlePlaces(aligned.links, traits, aligned.places);
  return aligned;
}

}  // namespace slamdb
