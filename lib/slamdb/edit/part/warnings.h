// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/notices.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/export.h"

namespace slamdb {

// Warns where the part is to be localised in and coverage is poor.
SLAMDB_EXPORT void WarnOfPoorCoverage(const Coverage& coverage, Notices& notices);

}  // namespace slamdb
