// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/edit/merge/detail/branch_ids.h"

// Which maps of three atlases are one map.
namespace slamdb::detail {

// Rows of the maps of each atlas. Several of one atlas: another one has joined them.
struct MapGroup {
  std::vector<std::uint32_t> base, ours, theirs;

  bool IsJoined() const { return base.size() > 1 || ours.size() > 1 || theirs.size() > 1; }
};

// By the keyframes that they share; maps without keyframes by their ids. In the order of ours, then theirs, then base.
//
// Throws Error (kNotPossible): a side has split a map of the base.
std::vector<MapGroup> GroupMaps(const Branches& branches, const std::array<std::string, 3>& names);

// Of a group in which maps were joined: moves all maps into one frame, that of the side which joined them, and makes
// one of those of each atlas, in the row of the first.
void LayTogether(Branches& branches, const MapGroup& group, int threads);

}  // namespace slamdb::detail
