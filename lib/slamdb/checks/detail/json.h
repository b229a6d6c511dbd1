// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/json.h"
#include "slamdb/checks/finding.h"

namespace slamdb::detail {

// {"place": {"map": 0, ...}, "where": "map 0, ...", "message": ...}
Json JsonOf(const Finding& finding);

}  // namespace slamdb::detail
