// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/build/build.h"

// The chain of the keyframes of an inertial map in time, which grows.
namespace slamdb::detail {

// A new keyframe, the one before it, and the one that came behind that until then; kNoRow: none. Rows of the map with
// the new keyframes behind its own.
struct ChainStep {
  std::uint32_t row, previous, next;
};

// Where new keyframes, of which all is given, go into the chain; those that begin one are left out.
// Throws Error (kUsage) with the row that has no place there.
std::vector<ChainStep> PlanChain(const Map& map, const NewKeyFrames& given);

// Links them, when they are in the map. Measurements that led over one are split at its time.
void FollowChain(Map& map, std::span<const ChainStep> steps);

}  // namespace slamdb::detail
