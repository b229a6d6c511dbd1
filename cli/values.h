// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// What values of options have to be, for ->check(), beside what options.h has.
namespace slamdb::cli {

std::string CheckFinite(const std::string& text);  // neither NaN nor infinity
std::string CheckPlace(const std::string& text);   // on earth, as ParseGeodetic takes it

}  // namespace slamdb::cli
