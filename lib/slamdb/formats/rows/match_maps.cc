// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/match_maps.h"

#include <algorithm>

#include "slamdb/formats/rows/detail/columns.h"

namespace slamdb::rows {
namespace {

std::size_t CountCommon(const Map& map, const std::vector<KeyframeKey>& keys) {
  return static_cast<std::size_t>(std::ranges::count_if(map.keyframes, [&](const KeyFrame& keyframe) {
    return keyframe.timestamp == keyframe.timestamp &&  // NaN is no time
           std::ranges::binary_search(keys, KeyframeKey{ToColumn(keyframe.id), keyframe.timestamp});
  }));
}

}  // namespace

std::vector<const StoredMap*> MatchMaps(const Atlas& atlas, std::vector<StoredMap>& stored) {
  struct Pair {
    std::size_t common, map, stored;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < stored.size(); ++k) {
    std::ranges::sort(stored[k].keys);
    for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
      const std::size_t common = CountCommon(atlas.maps[i], stored[k].keys);
      if (common > 0 || stored[k].id == ToColumn(atlas.maps[i].id)) pairs.push_back({common, i, k});
    }
  }
  std::ranges::stable_sort(pairs, [](const Pair& a, const Pair& b) { return a.common > b.common; });
  std::vector<const StoredMap*> match(atlas.maps.size(), nullptr);
  for (const Pair& pair : pairs) {
    if (match[pair.map] != nullptr || stored[pair.stored].used) continue;
    match[pair.map] = &stored[pair.stored];
    stored[pair.stored].used = true;
  }
  return match;
}

}  // namespace slamdb::rows
