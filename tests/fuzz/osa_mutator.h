// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "slamdb/base/file.h"
#include "slamdb/model/atlas.h"

// Atlases for the fuzzers of what works on atlases: anything that a file can hold, sound or not.
namespace slamdb::fuzz {

// The atlas in the bytes of an .osa file; nullopt where they are none.
std::optional<Atlas> AtlasOf(Bytes bytes);

// The bytes of an .osa file with the atlas; nullopt where it holds what no file can.
std::optional<std::string> Encoded(const Atlas& atlas);

// Changes a field of an entity or a list of entities, a few times over: numbers become others, extreme ones, or the ids
// of entities that are there; list elements and entities go, come twice or change places. Equal seeds do the same.
void Mutate(Atlas& atlas, std::uint64_t seed);

// A changed atlas that a file can hold as well; the same where it could not.
Atlas VariationOf(const Atlas& atlas, std::uint64_t seed);

}  // namespace slamdb::fuzz
