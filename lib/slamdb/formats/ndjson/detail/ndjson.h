// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The whole atlas as JSON, one object per line: the atlas, its cameras, then each map with its keyframes and its map
// points and landmarks. Read back with every field; what is left out is derived. schema/ndjson.md describes the lines.
// For jq, data frames and scripts.
extern const Format kNdjsonFormat;

}  // namespace slamdb::detail
