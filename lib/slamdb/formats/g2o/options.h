// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"

namespace slamdb {

// How pose graphs are written.
struct SLAMDB_EXPORT G2oWriteOptions {
  bool similarities = false;  // true: VERTEX_SIM3:EXPMAP and EDGE_SIM3:EXPMAP, whose keyframes have a scale each
};

}  // namespace slamdb
