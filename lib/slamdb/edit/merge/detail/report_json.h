// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/json.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"

namespace slamdb::detail {

// What ToJson writes, for reports that say more.
Json MergeJson(const MergeReport& report, const std::string& output);
Json JoinJson(const JoinReport& join);
Json FuseJson(const FuseReport& fused);
Json ThreeWayJson(const ThreeWayReport& report, const std::string& output);

}  // namespace slamdb::detail
