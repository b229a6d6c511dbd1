// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>

namespace slamdb::bench {

// What the figures depend on, as a Markdown list: processor, caches, memory, kernel, file system of the folder,
// compiler; what a page fault costs, and copies into memory that is fresh and that is not.
void PrintMachine(const std::string& folder, std::ostream& out);

}  // namespace slamdb::bench
