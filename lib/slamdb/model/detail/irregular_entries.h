// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Forgets null pointers and repetitions in the lists of an atlas (RepeatedEntry), whose positions and rows mean lists
// that are about to change. Returns how many there were.
std::uint64_t DropIrregularEntries(Atlas& atlas);

}  // namespace slamdb::detail
