// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// The hash of all that an atlas holds: every field to the bit, every list in its order, its encoding included.
// Equal atlases have equal hashes, in every version of slamdb and whatever they were read from; stores record it.
// XXH3-64: tells changes and damage, and is no defence against an adversary.
//
// Throws what allocating throws.
// Cost: linear. `threads` 0: every core.
SLAMDB_EXPORT std::uint64_t HashOf(const Atlas& atlas, int threads = 0);

// The same for the atlas with the default encoding: of what it says, however it is written down.
// Journals record it.
SLAMDB_EXPORT std::uint64_t HashWithoutEncoding(const Atlas& atlas, int threads = 0);

}  // namespace slamdb
