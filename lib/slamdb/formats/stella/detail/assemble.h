// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/format.h"
#include "slamdb/formats/stella/detail/stella_map.h"

namespace slamdb::stella {

// The atlas of what a file holds: a map for each part of it that neither the spanning tree nor loops nor points join to
// others, since those lie in frames of their own. What ORB-SLAM3 needs beyond is derived; notices say what is.
//
// Throws Error when a keyframe names a camera that is not there.
Atlas Assemble(StoredMap stored, const std::string& path, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::stella
