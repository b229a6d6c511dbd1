// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// `rtabmap`: databases of RTAB-Map, read only. schema/rtabmap.md has the tables.
extern const Format kRtabmapFormat;

// `rtabmap-truth`: the ground truth that such a database may hold, as a trajectory.
extern const Format kRtabmapTruthFormat;

}  // namespace slamdb::detail
