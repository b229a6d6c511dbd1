// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb {

// What ORB-SLAM3's PostLoad would make of an atlas, worked out from the description of what it does and not from the
// rules of `check`: one line for each object that makes it crash, and for each reference that it leaves null.
// `words`: that the vocabulary has.
std::vector<std::string> LoadTroubles(const Atlas& atlas, std::uint64_t words);

}  // namespace slamdb
