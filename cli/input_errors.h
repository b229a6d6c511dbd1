// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/console.h"
#include "slamdb/base/notices.h"
#include "slamdb/model/atlas.h"

namespace slamdb::cli {

// Says in one line when a check finds errors in an atlas that `input` names; nothing when quiet.
void TellErrors(const std::string& input, const Atlas& atlas, const Console& console, Notices& notices);

}  // namespace slamdb::cli
