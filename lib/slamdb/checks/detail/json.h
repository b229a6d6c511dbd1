// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/json.h"
#include "slamdb/checks/finding.h"
#include "slamdb/checks/report.h"

namespace slamdb::detail {

// {"place": {"map": 0, ...}, "where": "map 0, ...", "message": ...}, and back.
Json JsonOf(const Finding& finding);
Finding FindingOf(const Json& json);

// An item of `inputs` in schema/check.schema.json, and back: of the statistics that has what the gates measure.
//
// Throws Error (kDamaged) or nlohmann::json::exception for what is none.
Json JsonOf(const CheckedFile& file);
CheckedFile CheckedFileOf(const Json& json);

}  // namespace slamdb::detail
