// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/base/wording.h"
#include "slamdb/export.h"
#include "slamdb/formats/info.h"

namespace slamdb {

struct InfoRow {
  std::string label, value;
};

// The header of an atlas, without a heading, or one of its maps: `map 0`, `stereo with IMU`.
struct InfoSection {
  InfoRow heading;
  std::vector<InfoRow> rows;
};

// What is told of an atlas to people, the header first, then each map.
[[nodiscard]] SLAMDB_EXPORT std::vector<InfoSection> InfoSections(const AtlasInfo& report, const Wording& wording = {});

}  // namespace slamdb
