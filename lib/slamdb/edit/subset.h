// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb {

// A part of an atlas: one flag for each row of its lists, 1 = in the part.
struct Subset {
  struct MapRows {
    std::vector<std::uint8_t> keyframes, points;
  };
  std::vector<MapRows> maps;  // by row of Atlas::maps

  static Subset Everything(const Atlas& atlas);
  static Subset Nothing(const Atlas& atlas);
};

// What to do with what crosses the border of a part.
enum class Border {
  kStrict,          // the part as it is: references that leave it are dropped
  kCompletePoints,  // the part grows by all keyframes that observe a point of it
  kSmart,           // points with too few observers left to be held in place go; the part grows by none
};

// Changes `subset` by the rule of the border so that KeepSubset leaves a sound atlas. `index` is of the atlas.
void SettleBorder(const AtlasIndex& index, Border border, Subset& subset);

// What KeepSubset took away.
struct SubsetReport {
  std::uint64_t maps = 0, keyframes = 0, points = 0;     // entities
  std::uint64_t observations = 0, slots = 0, edges = 0;  // references out of the kept part
  std::uint64_t new_references = 0, new_parents = 0;     // keyframes chosen in place of removed ones
};

// Removes everything outside `subset` and closes what is left: observations, slots, covisibility, loop and merge edges
// that lead out are erased and counts made right; points get another reference keyframe, keyframes another parent as
// ORB-SLAM3's KeyFrame::SetBadFlag finds it; previous and next link over the gap, inertial preintegrations joined;
// initial, lowest and origin keyframes are chosen anew where they are gone; maps without keyframes go; cameras that no
// keyframe uses go. Points that no kept keyframe observes go too. Counters stay: ids are never handed out twice. In
// place, linear. A sound atlas stays sound; a subset of everything changes nothing.
SubsetReport KeepSubset(Atlas& atlas, const Subset& subset);

}  // namespace slamdb
