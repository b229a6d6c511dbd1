// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// Who does what, for the history.
namespace slamdb::rows {

std::string HostName();
std::string Who();        // `user@host`
std::string ToolName();   // `slamdb 0.1.0`
std::string TimeOfDay();  // now, UTC, ISO 8601

}  // namespace slamdb::rows
