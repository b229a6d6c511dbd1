// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/export.h"

// The version of the headers that a program was compiled with, for #if. CMakeLists.txt reads it from here.
#define SLAMDB_VERSION_MAJOR 0
#define SLAMDB_VERSION_MINOR 1
#define SLAMDB_VERSION_PATCH 0

namespace slamdb {

// The version of the library that a program runs with: `0.1.0`. docs/architecture.md says what semantic versioning
// covers.
SLAMDB_EXPORT std::string_view Version();

}  // namespace slamdb
