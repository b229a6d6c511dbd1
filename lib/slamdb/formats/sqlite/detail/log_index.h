// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/sqlite/detail/pages_beside.h"

namespace slamdb::sqlite {

// Which pages the write-ahead log of a database holds, up to its last commit, and where: as SQLite's format of that
// file has it (sqlite.org/fileformat2.html, section 4), checksums included. What follows a torn frame is no part of it.
PagesBeside IndexLog(int descriptor);

}  // namespace slamdb::sqlite
