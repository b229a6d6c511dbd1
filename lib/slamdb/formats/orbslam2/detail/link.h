// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

namespace slamdb::orbslam2 {

// Makes ids of the rows that stand where links are while a file is read, and sorts objects and links by id.
void LinkObjects(Map& map, int threads);

}  // namespace slamdb::orbslam2
