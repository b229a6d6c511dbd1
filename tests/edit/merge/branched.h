// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "slamdb/edit/merge/three_way.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/index.h"
#include "tests/edit/worlds.h"

// Two robots continue one atlas.
namespace slamdb {

inline constexpr std::size_t kOld = 12, kNew = 5;  // keyframes of the base, and that each side makes

struct Branched {
  Atlas base, ours, theirs;
};

// New ids collide, as each side goes on counting where the base ends.
Branched Branch(const World& world, std::uint64_t seed = 1);

// A point of the base that both sides have, too, and no keyframe of any sees together with that one.
MapPointId NeverSeenWith(MapPointId point, const Branched& branched);

// The keyframes of a map that `keeps(row)` says, with counters that are not above what is left.
template <class Keeps>
Atlas Part(const Atlas& atlas, const Keeps& keeps) {
  Atlas part = atlas;
  Subset subset = Subset::Everything(part);
  for (std::size_t row = 0; row < part.maps[0].keyframes.size(); ++row)
    subset.maps[0].keyframes[row] = keeps(row) ? 1 : 0;
  SettleBorder(AtlasIndex(part), Border::kSmart, subset);
  KeepSubset(part, subset);
  part.next_ids = {};
  RaiseCounters(part);
  part.next_ids.initial_keyframe = 0;
  return part;
}

}  // namespace slamdb
