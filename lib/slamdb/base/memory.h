// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slamdb/export.h"

namespace slamdb {

// How much memory the process is to take, and where what is more goes.
//
// Columns, in which the mass of an atlas is, are in memory until they take their share of `bytes`, and from then on in
// a file on disk that has no name. What of that file is in memory is let go whenever the process takes more than
// `bytes`, and comes back when it is looked at. So nothing that is computed, read or written depends on the limit.
//
// It holds as far as columns make up what is taken: what is held beside them, a few hundredths of an atlas, stays in
// memory. Under AddressSanitizer and ThreadSanitizer there is no limit.
struct MemoryLimit {
  std::uint64_t bytes = 0;   // of resident memory; 0: three quarters of what is free when it is first asked for
  std::string spill_folder;  // on disk; empty: TMPDIR where that is on disk, else /var/tmp
};

// For the whole process, from now on: what is in memory already stays there, and a file that is there stays where it
// is. Columns then throw Error (kOutOfResources) where the disk is full, and another kind where no file can be made in
// `spill_folder`. Where neither limit nor folder are set and none can be made, there is no limit.
//
// Thread-safe.
SLAMDB_EXPORT void SetMemoryLimit(const MemoryLimit& limit);

// What is on disk for want of memory.
struct Spilled {
  std::uint64_t bytes = 0;  // now
  std::uint64_t most = 0;   // at most, since the process began
  std::string folder;       // empty: nothing ever was
};
// Thread-safe.
SLAMDB_EXPORT Spilled SpilledNow();

}  // namespace slamdb
