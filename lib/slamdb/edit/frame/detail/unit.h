// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

// What gives the lengths of a map their unit.
namespace slamdb::detail {

// Whether it was made with a stereo pair or a depth camera, whose baseline is the unit.
bool HasStereo(const Map& map);

}  // namespace slamdb::detail
