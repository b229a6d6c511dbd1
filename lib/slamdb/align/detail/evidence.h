// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/align/align.h"
#include "slamdb/align/detail/global_fit.h"

namespace slamdb::detail {

// What speaks for and against a transform, but for how many hypotheses do.
AlignmentEvidence EvidenceFor(const MapPair& pair, const GlobalFit& global, int threads);

}  // namespace slamdb::detail
