// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "slamdb/align/align.h"

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

// The same points of two maps as fusing takes them: those with the least error first.
inline std::vector<std::pair<MapPointId, MapPointId>> SurestFirst(std::vector<MatchedPoints> matches) {
  std::ranges::stable_sort(matches, {}, &MatchedPoints::error);
  std::vector<std::pair<MapPointId, MapPointId>> same;
  for (const MatchedPoints& match : matches) same.emplace_back(match.first, match.second);
  return same;
}

}  // namespace slamdb::detail
