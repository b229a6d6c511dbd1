// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/align/detail/hypothesis.h"

namespace slamdb::detail {

// Whether two say the same of how the maps lie: to 3 degrees, 6 % of the scale and 5 % of the depth of what is seen, or
// so many times that.
bool Agree(const MapPair& pair, const Hypothesis& a, const Hypothesis& b, double slack = 1);

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
