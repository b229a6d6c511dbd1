// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/align/align.h"
#include "slamdb/align/locate.h"
#include "slamdb/align/loops.h"

namespace slamdb::detail {

// `27%`.
std::string Percent(double share);

// The answer when no two pictures of the maps agree on anything.
Alignment NothingAgrees();

// Whether the pictures of either map show what they must of the other.
bool PicturesConfirm(const AlignmentEvidence& evidence);

// Sets verdict and reason from the evidence.
void GiveVerdict(Alignment& alignment);
void GiveVerdict(Localization& localization);

// Likewise of a loop. `depth`: the map's median one.
void GiveVerdict(Loop& loop, double depth);

}  // namespace slamdb::detail
