// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/align/locate_report.h"

namespace slamdb::cli {

// Where pictures were found, a line each, for people. `benchmark`: keyframes that were left out, of which those that
// were found are told if `verbose` alone.
std::string LocateText(const LocateReport& report, bool benchmark, bool verbose);

}  // namespace slamdb::cli
