// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The points of georeferenced maps as LAS 1.2 in UTM: write only. Maps are in metres east, north and up of
// GeographicOptions::origin. schema/las.md has the bytes.
extern const Format kLasFormat;

}  // namespace slamdb::detail
