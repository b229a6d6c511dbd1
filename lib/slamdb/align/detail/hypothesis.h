// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/align/detail/fit.h"
#include "slamdb/align/detail/local_map.h"
#include "slamdb/align/detail/prepared_map.h"

namespace slamdb::detail {

// Two keyframes, one of each map, that may have been taken at one place.
struct Candidate {
  std::uint32_t first = 0, second = 0;  // left views
  float score = 0;                      // how alike the groups about them are
};

// What a candidate says of how the maps lie, and the matches that say so.
struct Hypothesis {
  Candidate candidate;
  Similarity3d first_from_second;
  std::vector<PointMatch> inliers;
};

// Two maps between which a transform is sought, with what the search needs of them.
struct MapPair {
  const PreparedMap &first, &second;
  PairGeometry geometry;
};

// Matches the local maps of a candidate and verifies them; nullopt when too few agree.
std::optional<Hypothesis> TryCandidate(const MapPair& pair, const Candidate& candidate, Search search);

// More matches of two local maps, sought where a transform says that they are: the points of each in the picture that
// the other is about. Each point of either is in one match at most.
std::vector<PointMatch> SearchByTransform(const MapPair& pair, const LocalMap& first, const LocalMap& second,
                                          const Similarity3d& first_from_second, double radius);

}  // namespace slamdb::detail
