// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"

// What the name of an output says.
namespace slamdb {

// Whether files are to be made in it: `parts/`, a folder that is there, or `parts`, a name without a suffix.
[[nodiscard]] SLAMDB_EXPORT bool NamesFolder(const std::string& output);

// Throws Error when it cannot be made.
SLAMDB_EXPORT void MakeFolder(const std::string& folder);

// Why browsers would not take it for a page; empty: they do.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNoPage(const std::string& output);

}  // namespace slamdb
