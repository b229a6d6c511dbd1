// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "slamdb/export.h"
#include "slamdb/live/atlas.h"
#include "slamdb/model/atlas.h"

// The only way between atlases at rest (ids, plain data) and live ones (pointers, locks).
namespace slamdb::live {

struct LiveAtlas {
  std::unique_ptr<Atlas> atlas;
  PostLoadReport report;
};

// Brings an atlas to life. Ids become pointers; what dangles is reported, left out of the graph, and kept as it was for
// ToModel.
// Linear, on `threads` threads (0: every core).
// Throws nothing but std::bad_alloc.
[[nodiscard]] SLAMDB_EXPORT LiveAtlas FromModel(slamdb::Atlas atlas, int threads = 0);

// The whole live atlas as it is now; changes wait meanwhile.
// Links lead only to what the map lists: what was flagged bad, or is in another map, is not linked. A new map without
// keyframes is left out.
// ToModel of FromModel of an atlas is that atlas, dangling links included (where a keyframe lists children or edges of
// which some dangle, these come last).
// Throws Error (kUsage) inside a Change of the atlas.
[[nodiscard]] SLAMDB_EXPORT slamdb::Atlas ToModel(Atlas& atlas, int threads = 0);

}  // namespace slamdb::live
