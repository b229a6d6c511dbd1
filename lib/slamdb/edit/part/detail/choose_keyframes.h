// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/edit/part/detail/kept_views.h"

namespace slamdb::detail {

// What a choice of keyframes must keep to.
struct KeyFrameBudget {
  std::size_t min_points;                     // for a place to be covered
  std::optional<std::size_t> keyframes;       // at most so many
  std::optional<std::uint64_t> bytes;         // at most so many
  std::uint64_t bytes_around = 0;             // beside keyframes and points
  std::vector<std::uint64_t> keyframe_bytes;  // by number, without observations
};

// The best of four ways to choose, by Quality, the first of equals:
//   greedy        one by one what adds most to places that are not covered yet, or in twos what adds more together
//   consecutive   the best run of keyframes, as they were made
//   evenly        runs of equal length, evenly spaced, from single keyframes to half of all in each
//   spaced        single keyframes, evenly spaced, from every one that they can begin with
// so that a choice covers never less than those that need no computing; then keyframes are exchanged one by one.
// Throws Error (kNotPossible) when the budget leaves no room for a single good keyframe, or there is none.
Subset ChooseKeyFrames(const Sights& sights, const KeyFrameBudget& budget);

}  // namespace slamdb::detail
