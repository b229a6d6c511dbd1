// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/export.h"
#include "slamdb/formats/store/store.h"

namespace slamdb {

// A map of a store that some maps may overlap with.
struct LikelyMap {
  std::string atlas;  // its name in the store
  MapId map;
  std::uint64_t keyframes = 0;  // of the maps at hand, that look like some place of it
};

struct LikelyMaps {
  std::vector<LikelyMap> maps;                    // that most keyframes look like first
  std::vector<std::string> unlike;                // other atlases of the store: nothing looks alike; ascending
  std::vector<std::string> unknown, unreachable;  // as in StoredPlaces
};

struct LikelyOptions {
  std::uint64_t most = 20;           // maps
  std::vector<std::string> without;  // atlases of the store that are passed over, as those that the maps are of
  int threads = 0;                   // 0: every core
};

// Which maps of a store may overlap with some maps: every keyframe asks the store what looks like it
// (Store::PlacesLike), and maps that two keyframes name are likely. AlignMaps tells.
//
// Cost: that of Store::PlacesLike with a picture a keyframe; no atlas is read.
[[nodiscard]] SLAMDB_EXPORT LikelyMaps FindLikelyMaps(Store& store, std::span<const MapRef> maps,
                                                      const LikelyOptions& options = {});

}  // namespace slamdb
