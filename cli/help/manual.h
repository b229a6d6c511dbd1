// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace slamdb::cli {

// The manual page of the program or of a verb, in roff with the macros of man(7).
std::string ManualPage(const CLI::App& app);

// "slamdb-info.1".
std::string ManualPageName(const CLI::App& app);

}  // namespace slamdb::cli
