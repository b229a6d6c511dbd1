// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// A recording with Foxglove's schemas, in protobuf: points, poses, frames along the timeline, edges, calibrations:
// write only. schema/mcap.md has topics and records. Foxglove, Lichtblick and the mcap tools play it.
extern const Format kMcapFormat;

}  // namespace slamdb::detail
