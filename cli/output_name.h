// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// What the name of an output says.
namespace slamdb::cli {

// Whether files are to be made in it: `parts/`, a folder that is there, or `parts`, a name without a suffix.
bool NamesFolder(const std::string& output);

// Throws Error when it cannot be made.
void MakeFolder(const std::string& folder);

// Ends with exit code 2 where browsers would not take it for a page.
void RequirePageName(const std::string& output);

}  // namespace slamdb::cli
