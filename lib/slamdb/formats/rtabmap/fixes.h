// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/geodetic.h"

namespace slamdb {

// The GPS fixes in a database of RTAB-Map, by time, at least one.
//
// Throws Error as ReadAtlas does, and kNotFound when it has none.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ReadRtabmapFixes(const Location& location);

}  // namespace slamdb
