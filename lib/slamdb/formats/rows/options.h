// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/rows/revisions.h"

namespace slamdb {

// How a store is opened to write.
struct StoreOptions {
  bool sync = true;         // a committed save survives power loss; false: it may be lost, the store stays whole
  double lock_timeout = 5;  // seconds to wait for another program that writes; infinity: for ever
  Progress progress;        // called while it waits; may be empty
};

// How ReadAtlas reads a store.
struct SLAMDB_EXPORT StoreReadOptions {
  double lock_timeout = 5;  // seconds to wait for another process that holds the store
  // SalvageAtlas takes rows that differ from their hash as they are, because somebody edited them in SQL on purpose,
  // and names them in Salvage::accepted; otherwise it leaves them out as damaged.
  bool accept_edits = false;
};

// How WriteAtlas writes to a store.
struct SLAMDB_EXPORT StoreWriteOptions {
  std::string provenance;             // one line for the history: what made this atlas (`convert session_a.osa`)
  double lock_timeout = 5;            // seconds to wait for another process that writes
  std::optional<RevisionName> from;   // what it was made of besides the revision before it, as by a merge
  std::optional<std::uint64_t> onto;  // the revision that it was made of: Error (kLocked) unless that is the newest yet
};

}  // namespace slamdb
