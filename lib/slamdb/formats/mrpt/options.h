// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"

namespace slamdb {

// How landmarks of MRPT 2 are written.
struct SLAMDB_EXPORT MrptWriteOptions {
  bool own_slots = false;  // ORB descriptors where MRPT 2 itself writes them, which then reads them as BLD
};

}  // namespace slamdb
