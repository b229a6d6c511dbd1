// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "slamdb/base/detail/json.h"
#include "slamdb/checks/finding.h"
#include "slamdb/checks/report.h"

namespace slamdb::detail {

// Runs it, and tells of what it throws that it is in that part of the report: of results[2].findings[0]. All of it is
// then an Error (kDamaged).
void InPart(const std::string& part, const std::function<void()>& work);
// Takes each item of a list, of which `name` tells. Throws Error (kDamaged) for what is no list.
void ForEachItem(const Json& list, const std::string& name, const std::function<void(const Json& item)>& take);

// {"place": {"map": 0, ...}, "where": "map 0, ...", "message": ...}, and back.
Json JsonOf(const Finding& finding);
Finding FindingOf(const Json& json);

// An item of `inputs` in schema/check.schema.json, and back: of the statistics that has what the gates measure.
//
// Throws Error (kDamaged) or nlohmann::json::exception for what is none.
Json JsonOf(const CheckedFile& file);
CheckedFile CheckedFileOf(const Json& json);

}  // namespace slamdb::detail
