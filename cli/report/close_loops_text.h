// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/align/close_loops.h"

namespace slamdb::cli {

// Which loops were found, what says so, and what was done, for people: a block for each map.
std::string CloseLoopsText(const CloseLoopsReport& report);

}  // namespace slamdb::cli
