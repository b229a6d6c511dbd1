// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// Who writes rows, as the log of an atlas and the list of a server's connections tell.
namespace slamdb::rows {

std::string HostName();  // `unknown` when the system does not tell
std::string Who();       // `user@host`
std::string ToolName();  // `slamdb 0.1.0`

}  // namespace slamdb::rows
