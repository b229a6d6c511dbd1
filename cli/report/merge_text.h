// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"

namespace slamdb::cli {

// What `merge` did, for people.
std::string MergeText(const MergeReport& report);

// What became of three atlases; the first of the conflicts.
std::string ThreeWayText(const ThreeWayReport& report);

// What a transform, anchors and fusing came to.
std::string JoinText(const JoinReport& join);

}  // namespace slamdb::cli
