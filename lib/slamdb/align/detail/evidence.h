// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/align/detail/global_fit.h"

namespace slamdb::detail {

// The second axis of the ellipsoid of the matched points, in median depths of the first map.
double ExtentOf(const MapViews& first, const std::vector<PointMatch>& matches);

// What speaks for and against a transform, but for how many hypotheses do.
AlignmentEvidence EvidenceFor(const MapPair& pair, const GlobalFit& global, int threads);

}  // namespace slamdb::detail
