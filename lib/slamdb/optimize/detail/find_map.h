// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// The row of a map, or of keyframes in it. Throw Error (kNotFound).
std::size_t FindMap(const Atlas& atlas, MapId id);
std::vector<std::uint32_t> RowsOf(const Map& map, std::span<const KeyFrameId> ids);

}  // namespace slamdb::detail
