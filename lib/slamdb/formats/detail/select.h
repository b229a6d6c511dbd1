// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Leaves the maps, keyframes and points of an atlas that are selected, for readers that read all.
void Select(const Selection& selection, Atlas& atlas);

}  // namespace slamdb::detail
