// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// The least counters that are above the ids of all that is in the atlas; points and landmarks share one.
// `initial_keyframe` is 0.
//
// Cost: linear.
SLAMDB_EXPORT Counters LeastCounters(const Atlas& atlas);

// Raises counters to those, so that no id is handed out twice.
// Returns how many were too low.
//
// Cost: linear.
SLAMDB_EXPORT std::size_t RaiseCounters(Atlas& atlas);

}  // namespace slamdb
