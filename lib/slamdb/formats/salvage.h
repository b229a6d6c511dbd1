// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/formats/format.h"
#include "slamdb/model/salvage.h"

namespace slamdb {

// Reads what can be read, with the format of the input: ORB-SLAM3 files (orbslam3/salvage.h), stores (sqlite/salvage.h)
// and MRPT landmarks (mrpt/mrpt.h). Throws Error when nothing can, or for another format.
Salvage SalvageAtlas(const Location& location, const ReadOptions& options, std::string_view from = {});

}  // namespace slamdb
