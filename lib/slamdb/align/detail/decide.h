// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/align/align.h"
#include "slamdb/align/detail/map_views.h"

namespace slamdb::detail {

// The answer when no two pictures of the maps agree on anything.
Alignment NothingAgrees(std::size_t candidates, bool own_vocabulary);

// Sets verdict and reason from the evidence.
void GiveVerdict(const MapViews& first, const MapViews& second, Alignment& alignment);

}  // namespace slamdb::detail
