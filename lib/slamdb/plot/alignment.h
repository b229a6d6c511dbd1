// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/align/align.h"
#include "slamdb/export.h"
#include "slamdb/plot/plot.h"

namespace slamdb {

// Draws how two maps lie to each other: plans before and after, how well the matches fit, and the pair of keyframes
// that agrees on most points, with its matches.
// Of the options width, scale, format, dark and title count.
//
// Throws Error:
//   kUnsupported  slamdb was built without Cairo
//   kUsage        width or scale out of range
//   kNotPossible  nothing agreed, so that there is nothing to show
// Cost: linear in keyframes and points.
[[nodiscard]] SLAMDB_EXPORT Plot DrawAlignment(MapRef first, MapRef second, const Alignment& alignment,
                                               const PlotOptions& options = {});

}  // namespace slamdb
