// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/select.h"
#include "slamdb/export.h"

namespace slamdb {

struct ExtractOptions {
  SelectOptions part;
  Border border = Border::kSmart;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

struct ExtractReport {
  SubsetReport removed;
  Coverage coverage;
};

// Keeps a part of an atlas and closes it: Select, SettleBorder, KeepSubset.
//
// Throws Error, and then changes nothing: as Select does; kUsage when complete points would bring back what `except`
// takes out; kNotPossible when no keyframe or landmark is in the part.
// Cost: linear, in place; the result is the same for any number of threads.
SLAMDB_EXPORT ExtractReport Extract(Atlas& atlas, const ExtractOptions& options = {});

// As schema/extract.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ExtractReport& report, const ReportFiles& files = {});

}  // namespace slamdb
