// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"

namespace slamdb {

// How ReadAtlas reads a store.
struct SLAMDB_EXPORT StoreReadOptions {
  double lock_timeout = 5;  // seconds to wait for another process that holds the store
};

// How WriteAtlas writes to a store.
struct SLAMDB_EXPORT StoreWriteOptions {
  std::string provenance;   // one line for the history: what made this atlas (`convert session_a.osa`)
  double lock_timeout = 5;  // seconds to wait for another process that writes
};

}  // namespace slamdb
