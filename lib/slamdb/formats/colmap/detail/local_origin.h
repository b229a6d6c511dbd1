// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "slamdb/base/notices.h"
#include "slamdb/formats/colmap/detail/models.h"

namespace slamdb::colmap {

// Moves models whose coordinates are of the world (ECEF, UTM) to an origin among them, the same for all, since the
// 32-bit floats of an atlas would round them by half a metre. Says which. What lies about its origin stays as it is.
//
// Cost: linear.
void MoveToLocalOrigin(std::span<NamedModel> models, Notices& notices);

}  // namespace slamdb::colmap
