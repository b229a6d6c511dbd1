// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "slamdb/formats/info.h"

namespace slamdb::cli {

// What `slamdb info` says of one atlas, for people. With `plan_width` columns above 0 the path of each map is drawn in
// so many, of the six maps with most keyframes.
std::string InfoText(const AtlasInfo& report, std::size_t plan_width = 0);

}  // namespace slamdb::cli
