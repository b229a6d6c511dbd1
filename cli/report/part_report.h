// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"

// What verbs that keep a part of an atlas say about it, in words and as JSON, the same for all of them.
namespace slamdb::cli {

struct Totals {
  std::uint64_t maps = 0, keyframes = 0, points = 0, landmarks = 0;
  static Totals Of(const Atlas& atlas);
};

// kept 1 of 2 maps, 46 of 106 keyframes, 3,155 of 6,911 points
// cut 120 observations, ...
std::string PartText(const Totals& before, const Totals& after, const SubsetReport& removed);
// Warns when no keyframe, or no point, of many is left.
void WarnIfNothingIsLeft(const Totals& before, const Totals& after, Notices& notices);
// covers 45 of 46 places (97%), 46 before; a place is covered with 50 points
std::string CoverageText(const Coverage& coverage);

// {"before": .., "after": .., "cut": .., "chosen": ..}
nlohmann::ordered_json PartJson(const Totals& before, const Totals& after, const SubsetReport& removed);
nlohmann::ordered_json CoverageJson(const Coverage& coverage);

// --border, and what it means.
inline constexpr const char* kBorders[] = {"strict", "complete-points", "smart"};
Border BorderOf(const std::string& name);

}  // namespace slamdb::cli
