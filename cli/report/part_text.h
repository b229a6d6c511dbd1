// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"

// What verbs that keep a part of an atlas say about it, the same for all of them.
namespace slamdb::cli {

// kept 1 of 2 maps, 46 of 106 keyframes, 3,155 of 6,911 points
// cut 120 observations, ...
std::string PartText(const SubsetReport& removed);
// covers 45 of 46 places (97%), 46 before; a place is covered with 50 points
std::string CoverageText(const Coverage& coverage);

}  // namespace slamdb::cli
