// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slamdb/formats/info.h"

namespace slamdb::cli {

struct InfoRow {
  std::string label, value;
};

// The header of an atlas, without a heading, or one of its maps: `map 0`, `stereo with IMU`.
struct InfoSection {
  InfoRow heading;
  std::vector<InfoRow> rows;
};

// What is told of an atlas, the header first, then each map.
std::vector<InfoSection> InfoSections(const AtlasInfo& report);

// What `slamdb info` says of one atlas, for people. With `plan_width` columns above 0 the path of each map is drawn in
// so many, of the six maps with most keyframes.
std::string InfoText(const AtlasInfo& report, std::size_t plan_width = 0);

}  // namespace slamdb::cli
