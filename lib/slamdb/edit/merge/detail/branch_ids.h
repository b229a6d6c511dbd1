// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/atlas.h"

// One numbering for three atlases: afterwards equal ids are one thing, and things that are one have equal ids.
namespace slamdb::detail {

struct Branches {
  Atlas base, ours, theirs;
};

// The side that has every image which the other took since the base, of which there are some: it was made of it.
std::optional<BranchSide> FindContaining(const Branches& branches, int threads);

// What renumbering did to theirs, and what it found.
struct UnifiedIds {
  std::array<std::uint64_t, kIdKinds> shift{};      // of ids made since the base
  std::uint64_t other_images = 0;                   // keyframes of a side with an id of the base and another image
  std::array<std::vector<IdPair>, kIdKinds> pairs;  // of theirs; ascending, each once
};

// Recognises keyframes by their images and points by who sees them (MergeThreeWays), and renumbers base and theirs:
// what ours has gets the ids of ours, else what the base has keeps its own, and new things of theirs are shifted, kind
// by kind, where ours has made some, too. Ours stays as it is.
//
// Ids are expected to be there once in each atlas.
//
// Throws Error (kNotPossible): a side has no keyframe of the base; ids would pass LargestId.
// Cost: linear, but for sorting.
UnifiedIds UnifyIds(Branches& branches, const std::array<std::string, 3>& names, int threads);

}  // namespace slamdb::detail
