// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/edit/merge/merge.h"

namespace slamdb::cli {

// What `merge` did, for people and as JSON (schema/merge.schema.json). `output` is empty when nothing was written.
std::string MergeText(const MergeReport& report);
std::string MergeJson(const MergeReport& report, const std::string& output);

}  // namespace slamdb::cli
