// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/align/detail/hypothesis.h"

namespace slamdb::detail {

// Hypotheses that agree, each with each, on how the maps lie.
// After pairwise consistent measurement sets (Mangelson et al., ICRA 2018), taken greedily.
struct Consensus {
  std::vector<std::uint32_t> members;  // rows, the leader first
  std::size_t inliers = 0;             // of all members
  std::size_t second_keyframes = 0;    // different ones
};

// By inliers, the most first; no hypothesis is in two.
std::vector<Consensus> FindConsensus(const MapPair& pair, std::span<const Hypothesis> hypotheses);

}  // namespace slamdb::detail
