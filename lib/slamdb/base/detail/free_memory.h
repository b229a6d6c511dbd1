// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slamdb/export.h"

namespace slamdb::detail {

// Bytes that a process could take before the system or its container is short of memory: MemAvailable of Linux, or what
// the limits of the control groups that this process is in leave, whichever is less. What the page cache can give back
// counts as free. The largest number where nothing is known.
// Files are looked for below `root`, for tests.
SLAMDB_EXPORT std::uint64_t FreeMemory(const std::string& root = "");

}  // namespace slamdb::detail
