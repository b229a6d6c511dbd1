// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "slamdb/align/detail/hypothesis.h"
#include "slamdb/align/place_index.h"

namespace slamdb::detail {

// For each view the views that share most points with it, for all left views of a map.
std::vector<std::vector<std::uint32_t>> CovisibilityGroups(const MapViews& map, int threads);

// For each picture that is asked for (by view; null is none) the three places of the map that look most like it; the
// most alike first. Covisible keyframes vote together, and the best of them stands for the place.
// `silence` sets the scores to 0 of views that may not be an answer for the view that is asked for; empty: none.
// After ORB-SLAM3's place recognition, without its thresholds.
using Silence = std::function<void(std::uint32_t asked, std::span<float> scores)>;
std::vector<Candidate> FindCandidates(const PlaceIndex& index, std::span<const std::vector<std::uint32_t>> groups,
                                      std::span<const BagOfWords* const> asked, int threads,
                                      const Silence& silence = {});

}  // namespace slamdb::detail
