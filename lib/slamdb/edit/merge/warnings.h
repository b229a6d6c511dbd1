// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/export.h"

// About the inputs of a merge.
namespace slamdb {

// What does not go together, and what is lost.
SLAMDB_EXPORT void TellWarnings(const MergeReport& report, Notices& notices);

// An input that is named again gets a number, so that reports tell the two apart.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> DistinctNames(std::vector<std::string> names);

// Whether all of them have landmarks, and no keyframe: joined, they are fused unless told otherwise, as MRPT does.
[[nodiscard]] SLAMDB_EXPORT bool HoldLandmarksAlone(const std::vector<Atlas>& atlases);

}  // namespace slamdb
