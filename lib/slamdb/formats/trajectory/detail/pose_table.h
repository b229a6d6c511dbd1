// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/table.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"

namespace slamdb::detail {

// The columns of trajectories, in the order that they have without names.
struct PoseColumns {
  std::size_t time = 0, position = 1, qx = 4, qy = 5, qz = 6, qw = 7, is_lost = 8;
};
PoseColumns ColumnsOf(PoseLayout layout);
const TableKind& PoseTable(PoseLayout layout);

}  // namespace slamdb::detail
