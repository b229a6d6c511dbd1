// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/format.h"

namespace slamdb::cli {

// Throws CLI::ValidationError when --time-unit or --times would be without effect on an input of the format.
void RefuseIdleTimes(const Format& input, const std::string& time_unit, const std::string& times);

}  // namespace slamdb::cli
