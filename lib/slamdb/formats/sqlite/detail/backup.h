// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// Copies the whole database with SQLite's online backup, while others may read and write it.
//   A new file    appears whole or not at all, with the permissions of the original
//   `overwrite`   the store that is there becomes the copy in one transaction, under its lock: whatever fails leaves it
//                 as it was, and so does a save that ends there while this waits for the lock
//
// Throws Error: kAlreadyExists when the target is there and not `overwrite`; kLocked when others write there;
// kUnsupported when it is no store; disk full, no permission.
void BackupTo(Database& source, const std::string& target, bool overwrite);

}  // namespace slamdb::sqlite
