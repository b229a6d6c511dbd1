// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// Moves a map into another world frame: everything in it that has a length, a direction or a pose, coherently. Which
// field how is written in docs/transform.md. Linear; in place; uses `threads` threads (0: every core) and gives the
// same bytes for any number of them. Throws Error when the transform is not finite or its scale not positive, before it
// changes anything.
void TransformMap(Map& map, const Similarity3d& target_from_source, int threads = 0);

}  // namespace slamdb
