// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/model/atlas.h"

namespace slamdb::bench {

// A store on a server of its own, through its socket, beside one in a file, as markdown.
//
// Each row is measured in pairs, the one and the other in turn: medians, the processor time of the client and of the
// server, and the ratio of the pairs with its least and greatest. Rows that say so have something else beside them.
int CompareStores(const std::string& path, int rounds);

// After one keyframe and one point in a hundred have moved, and the keyframe lost its first keypoint's match; another
// each time.
Atlas Changed(Atlas atlas, int round);

}  // namespace slamdb::bench
