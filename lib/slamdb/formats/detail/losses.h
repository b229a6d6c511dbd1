// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// What an atlas, or one map of it, really has: a monocular atlas has no inertial data, an empty one nothing.
Content ContentOf(const Atlas& atlas, std::optional<MapId> map = std::nullopt);

// One sentence with a count for each kind of content that the atlas has and the format cannot hold, in the order of
// Content: `ply cannot hold keyframe poses (27)`. With ExportOptions::map only that map counts. O(keyframes + points).
std::vector<std::string> LossesOf(const Atlas& atlas, const Format& format, const WriteOptions& options);

}  // namespace slamdb::detail
