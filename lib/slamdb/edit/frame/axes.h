// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string_view>

#include "slamdb/export.h"

namespace slamdb {

// A change of axis convention as text, as the rotation target_from_source:
//   FROM:TO     of the conventions camera (x right, y down, z forward), ros (x forward, y left, z up), enu (x right,
//               y forward, z up), ned (x forward, y right, z down) and opengl (x right, y up, z backward)
//   `x,-z,y`    the axes of the target in those of the source: x' = x, y' = -z, z' = y
//
// Throws Error (kUsage) when the text is neither, or mirrors: a map seen in a mirror is no map.
[[nodiscard]] SLAMDB_EXPORT Eigen::Quaterniond ParseAxes(std::string_view text);

}  // namespace slamdb
