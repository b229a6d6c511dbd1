// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

// Which maps of an atlas are those that a store has of it.
namespace slamdb::rows {

// What tells that a keyframe is one that is stored, whatever the id of its map: its id and its time.
struct KeyframeKey {
  std::int64_t id;
  double timestamp;
  friend auto operator<=>(const KeyframeKey&, const KeyframeKey&) = default;
};

struct StoredMap {
  std::int64_t row = 0, id = 0, position = 0, hash = 0;
  std::vector<KeyframeKey> keys;  // of its keyframes that have a time
  bool used = false;              // it is a map of the atlas
};

// For each map of the atlas the stored map that it is, or null: the one with which it has most keyframes in common,
// because a map that was loaded and continued has another id; else the one of its id. Sorts their keys.
std::vector<const StoredMap*> MatchMaps(const Atlas& atlas, std::vector<StoredMap>& stored);

}  // namespace slamdb::rows
