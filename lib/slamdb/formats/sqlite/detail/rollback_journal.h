// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/sqlite/detail/pages_beside.h"

namespace slamdb::sqlite {

// The rollback journal of a transaction that did not end: the pages as they were before it. With them laid over the
// file and its length as recorded, the file is what it was after the last transaction that did.
// https://sqlite.org/fileformat2.html#the_rollback_journal
struct RollbackJournal {
  PagesBeside before;
  // False: the journal breaks off, records differ from their checksums, or it is that of several databases. Then it has
  // no pages.
  bool whole = true;
};

// Reads the open file. One without a valid header has no pages: SQLite has overwritten it when the transaction ended.
RollbackJournal ReadRollbackJournal(int descriptor);

}  // namespace slamdb::sqlite
