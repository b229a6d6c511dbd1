// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slamdb::detail {

// The pairs of keyframes that stand for all that agree, as edges and constraints: each keyframe is in one alone.
// `pairs`: the strongest first.
template <class Pair>
std::vector<Pair> StrongestPairs(const std::vector<Pair>& pairs, std::size_t most = 5) {
  std::vector<Pair> strongest;
  for (const Pair& pair : pairs) {
    const bool taken = std::ranges::any_of(
        strongest, [&](const Pair& other) { return other.first == pair.first || other.second == pair.second; });
    if (!taken && strongest.size() < most) strongest.push_back(pair);
  }
  return strongest;
}

}  // namespace slamdb::detail
