// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/base/detail/table.h"

// What tables call the columns of a pose.
namespace slamdb::detail {

// x, y, z.
inline Column PositionColumn(std::size_t axis) {
  static const Column kColumns[] = {{{"tx", ".position.x", ".translation.x", "p_rs_r_x", "p_x", "px", "pos_x", "x"}},
                                    {{"ty", ".position.y", ".translation.y", "p_rs_r_y", "p_y", "py", "pos_y", "y"}},
                                    {{"tz", ".position.z", ".translation.z", "p_rs_r_z", "p_z", "pz", "pos_z", "z"}}};
  return kColumns[axis];
}

// x, y, z, w.
inline Column QuaternionColumn(std::size_t part) {
  static const Column kColumns[] = {
      {{"qx", ".orientation.x", ".rotation.x", "q_rs_x", "q_x", "quat_x", "quaternion_x"}},
      {{"qy", ".orientation.y", ".rotation.y", "q_rs_y", "q_y", "quat_y", "quaternion_y"}},
      {{"qz", ".orientation.z", ".rotation.z", "q_rs_z", "q_z", "quat_z", "quaternion_z"}},
      {{"qw", ".orientation.w", ".rotation.w", "q_rs_w", "q_w", "quat_w", "quaternion_w"}}};
  return kColumns[part];
}

}  // namespace slamdb::detail
