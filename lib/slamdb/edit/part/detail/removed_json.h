// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/subset.h"
#include "slamdb/model/detail/json.h"

namespace slamdb::detail {

// What the reports of all verbs that keep a part have in common: `before`, `after`, `cut`, `chosen`.
void AddRemoved(const SubsetReport& removed, Json& json);

}  // namespace slamdb::detail
