// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/likely_maps.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "slamdb/model/picture_features.h"

namespace slamdb {
namespace {

constexpr double kAlike = 9;            // likeness: what keyframes of other places seldom come to
constexpr std::uint64_t kFewest = 2;    // keyframes that look like a map
constexpr std::size_t kMapsNamed = 20;  // by each keyframe

}  // namespace

LikelyMaps FindLikelyMaps(Store& store, std::span<const MapRef> maps, const LikelyOptions& options) {
  std::vector<std::span<const Descriptor>> pictures;
  for (const MapRef& map : maps)
    for (const KeyFrame& keyframe : map.atlas->maps[map.map].keyframes)
      pictures.push_back(LeftDescriptors(keyframe.features));
  const StoredPlaces places = store.PlacesLike(
      pictures,
      {.places = kMapsNamed, .of_map = 1, .faint = true, .without = options.without, .threads = options.threads});
  std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> counts;
  for (const std::vector<StoredPlace>& named : places.by_picture)
    for (const StoredPlace& place : named)
      if (place.likeness >= kAlike) ++counts[{place.atlas, place.map.value()}];
  LikelyMaps likely{.maps = {}, .unlike = {}, .unknown = places.unknown, .unreachable = places.unreachable};
  for (const auto& [map, keyframes] : counts)
    if (keyframes >= kFewest) likely.maps.push_back({map.first, MapId(map.second), keyframes});
  std::ranges::stable_sort(likely.maps, std::greater(), &LikelyMap::keyframes);
  if (likely.maps.size() > options.most) likely.maps.resize(options.most);
  std::set<std::string> named(likely.unknown.begin(), likely.unknown.end());
  named.insert(likely.unreachable.begin(), likely.unreachable.end());
  named.insert(options.without.begin(), options.without.end());
  for (const LikelyMap& map : likely.maps) named.insert(map.atlas);
  for (const std::string& atlas : store.Names())
    if (!named.contains(atlas)) likely.unlike.push_back(atlas);
  return likely;
}

}  // namespace slamdb
