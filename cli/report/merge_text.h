// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/edit/merge/merge.h"

namespace slamdb::cli {

// What `merge` did, for people.
std::string MergeText(const MergeReport& report);

// What a transform, anchors and fusing came to.
std::string JoinText(const JoinReport& join);

}  // namespace slamdb::cli
