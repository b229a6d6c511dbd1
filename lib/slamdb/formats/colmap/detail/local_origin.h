// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "slamdb/base/notices.h"
#include "slamdb/formats/colmap/detail/models.h"

namespace slamdb::colmap {

// Moves models whose coordinates are of the world (ECEF, UTM) to an origin among them, the same for all, since the
// 32-bit floats of an atlas would round them by half a metre. What lies about its origin stays as it is.
//
// Returns what was taken off all positions: zero where they stay. Cost: linear.
Eigen::Vector3d MoveToLocalOrigin(std::span<NamedModel> models);

// Says what was taken off, if anything.
void WarnOfLocalOrigin(const Eigen::Vector3d& origin, Notices& notices);

}  // namespace slamdb::colmap
