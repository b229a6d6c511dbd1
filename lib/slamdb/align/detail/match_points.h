// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/align/detail/local_map.h"

namespace slamdb::detail {

// How many bits descriptors of one thing may differ in, when nothing else tells that they are one.
inline constexpr int kMostBits = 60;

// The same thing in two maps: a point of each, and a picture of each in which it is seen.
struct PointMatch {
  LocalPoint first, second;
};

enum class Search {
  kAll,    // every point with every point
  kNodes,  // points whose keypoints are in one node of the vocabulary: several times faster, a few matches fewer
};

// Points of two local maps that are each other's most alike, with no rival: a point that is nearly as alike.
// Who lies where the best one lies is no rival, but the same thing once more.
// By the first one's rows.
std::vector<PointMatch> MatchPoints(const MapViews& first, const LocalMap& first_local, const MapViews& second,
                                    const LocalMap& second_local, Search search);

}  // namespace slamdb::detail
