// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/info.h"

namespace slamdb::cli {

// What `slamdb info` says of one atlas, for people.
std::string InfoText(const AtlasInfo& report);

// "Boost 1.73 to 1.75" for an archive library version; empty for one that is not known.
std::string BoostReleases(std::uint32_t version);

}  // namespace slamdb::cli
