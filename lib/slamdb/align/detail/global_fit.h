// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "slamdb/align/detail/consensus.h"
#include "slamdb/align/detail/hypothesis.h"

namespace slamdb::detail {

// The transform between two maps over all matches, and these.
struct GlobalFit {
  Fit fit;
  std::vector<PointMatch> matches;  // inliers, each pair of points once
};

// Begins with the matches of a consensus, then looks for more from all keyframes of the second map.
GlobalFit FitEverywhere(const MapPair& pair, std::span<const Hypothesis> hypotheses, const Consensus& consensus,
                        int threads);

}  // namespace slamdb::detail
