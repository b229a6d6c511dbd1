// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/export.h"

// What a user should know of landmarks that became points, or did not.
namespace slamdb {

// Throws Error (kNotPossible) when the atlas has none, or none was made, which says why.
SLAMDB_EXPORT void RequireLandmarks(const Atlas& atlas);
SLAMDB_EXPORT void RequireMade(const MakeLandmarksReport& report);

// Of points that were added and nothing observes.
SLAMDB_EXPORT void WarnOfUnobserved(std::uint64_t added, Notices& notices);

// Of landmarks that were left out or turned. `into`: how the atlas is called.
SLAMDB_EXPORT void TellWarnings(const MakePointsReport& report, Notices& notices);
SLAMDB_EXPORT void TellWarnings(const LayLandmarksReport& report, const std::string& into, Notices& notices);

}  // namespace slamdb
