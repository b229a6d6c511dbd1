// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/rows/detail/provenance.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

using rows::HostName;
using rows::TimeOfDay;
using rows::ToolName;
using rows::Who;

// The write lock of a store for one transaction. SQLite keeps the lock; a row of the table `writer`, committed before,
// tells others who holds it. Commit() removes the row with the work itself.
class WriteTransaction {
 public:
  // Waits for another writer as long as the connection waits, then throws Error: `locked by slamdb 0.1.0, process 4711
  // on host lab, since ...`. Throws Error as well when the file is no longer where it was opened.
  explicit WriteTransaction(Database& database);
  void Commit();

 private:
  std::unique_ptr<Transaction> transaction_;
  Database& database_;
};

// The error of a store that somebody else is writing: says who, as far as is known.
Error LockedError(Database& database);

// Does the work, and throws LockedError in place of an error that only says that the store is locked.
template <class Work>
void NamingHolder(Database& database, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kLocked) throw LockedError(database);
    throw;
  }
}

// Whether the file is where the connection opened it; what is written to one that was removed or moved away is lost.
bool StillThere(Database& database);
// Throws Error (kLocked) when it is not.
void CheckStillThere(Database& database);

}  // namespace slamdb::sqlite
