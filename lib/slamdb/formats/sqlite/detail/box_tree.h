// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// The position of a point as map_point_box has it; no coordinate is NaN.
struct PointBox {
  std::int64_t row = 0;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
};

// Enters or replaces the positions of points in the R*Tree map_point_box. Few are inserted one by one; many (compared
// with what is there) by building the whole tree anew from its leaves up, which is ten times faster and packs it
// tighter. Points are brought into the order of a space-filling curve either way, so that neighbours share a node.
void UpdateBoxes(Database& database, std::vector<PointBox> boxes);

}  // namespace slamdb::sqlite
