// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slamdb::store_test {

// The first column of the first row, as a person with psql would see it; `ERROR ...` where there is none to be had.
std::string SqlOn(const std::string& uri, const std::string& sql);

}  // namespace slamdb::store_test
