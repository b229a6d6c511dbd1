// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Tables for spreadsheets and data frames, one kind of entity per file: comma separated, one header line, `\n` at line
// ends, empty cells where there is nothing. Write only. schema/csv.md has the columns. Elements flagged bad are left
// out.
extern const Format kCsvFormat;              // csv: map points
extern const Format kCsvKeyFramesFormat;     // csv-keyframes
extern const Format kCsvObservationsFormat;  // csv-observations

}  // namespace slamdb::detail
