// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/model/atlas.h"
#include "slamdb/model/rigid.h"

namespace slamdb::detail {

// The axis of a map's frame, x, y or z or against it, that is nearest to up: where the upper edges of the cameras'
// images point to on average. Where they point everywhere, z in a map with initialised IMU, and -y in others, as
// ORB-SLAM3 has them. edit/frame/gravity.h finds up itself.
Eigen::Vector3f UpwardAxis(const Map& map);

// The smallest rotation that takes one axis to another, y or z; about x where they are opposite.
Quaternionf TurnOf(const Eigen::Vector3f& axis, const Eigen::Vector3f& onto);

}  // namespace slamdb::detail
