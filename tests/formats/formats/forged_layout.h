// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/layouts/layout.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// Makes of an atlas one that was read from a file of that layout: every member that a fork has beyond the model is some
// number, text or list that is no other one's.
void ForgeLayout(const Layout& layout, Atlas& atlas);

}  // namespace slamdb
