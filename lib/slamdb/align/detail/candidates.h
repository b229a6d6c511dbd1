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

// The places of a map that look most like a picture, as rows of `groups`, by how alike each view is; the most alike
// first. Covisible keyframes vote together, and the best of them stands for the place. After ORB-SLAM3's place
// recognition, without its thresholds.
std::vector<Candidate> BestPlaces(const std::vector<float>& scores, std::span<const std::vector<std::uint32_t>> groups,
                                  std::uint32_t second, std::size_t count);

// For each picture that is asked for (by view; null is none) its three best places in the map; the most alike first.
// `silence` sets the scores to 0 of views that may not be an answer for the view that is asked for; empty: none.
using Silence = std::function<void(std::uint32_t asked, std::span<float> scores)>;
std::vector<Candidate> FindCandidates(const PlaceIndex& index, std::span<const std::vector<std::uint32_t>> groups,
                                      std::span<const BagOfWords* const> asked, int threads,
                                      const Silence& silence = {});

}  // namespace slamdb::detail
