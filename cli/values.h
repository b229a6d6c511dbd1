// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "cli/limits.h"

// What values of options have to be, for ->check(), beside what options.h has.
namespace slamdb::cli {

// A number within them.
std::function<std::string(const std::string&)> Within(const Limits& limits);
std::string CheckPlace(const std::string& text);  // on earth, as ParseGeodetic takes it

}  // namespace slamdb::cli
