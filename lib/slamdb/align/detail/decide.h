// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/align/align.h"
#include "slamdb/align/locate.h"

namespace slamdb::detail {

// The answer when no two pictures of the maps agree on anything.
Alignment NothingAgrees();

// Sets verdict and reason from the evidence.
void GiveVerdict(Alignment& alignment);
void GiveVerdict(Localization& localization);

}  // namespace slamdb::detail
