// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/sqlite/detail/database.h"

// Stores that are being made, and how a connection is set up to write.
namespace slamdb::sqlite {

// Whether it is a database without any table, out of which a store can be made.
bool IsEmptyDatabase(Database& database);

// Whether nothing was ever saved there.
bool IsUnused(Database& database);

// Waits for who makes the store. The index of the log lies there while a program has it open.
void WaitUntilMade(Database& database, bool had_index);

// Makes the store where there is none yet. Throws Error where it is not of this version, or no store. `sync`: a save
// that has returned survives power loss.
void PrepareToWrite(Database& database, bool sync);

}  // namespace slamdb::sqlite
