// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"

// What verbs that keep a part of an atlas say about it, the same for all of them.
namespace slamdb::cli {

// kept 1 of 2 maps, 46 of 106 keyframes, 3,155 of 6,911 points
// cut 120 observations, ...
std::string PartText(const SubsetReport& removed);
// Warns when a part that is to be localised in covers too little of what the whole covers.
void WarnOfPoorCoverage(const Coverage& coverage, Notices& notices);
// covers 45 of 46 places (97%), 46 before; a place is covered with 50 points
std::string CoverageText(const Coverage& coverage);

// What --border takes.
inline const std::map<std::string, Border> kBorders = {
    {"strict", Border::kStrict}, {"complete-points", Border::kCompletePoints}, {"smart", Border::kSmart}};

}  // namespace slamdb::cli
