// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/export.h"

namespace slamdb::detail {

// Whether what is read or written is a whole file, or one atlas of several in a store. An empty name is an atlas of a
// store whose name is not known yet.
using AtlasName = std::optional<std::string>;

// What a run of the command reads and writes. An output must be none of the inputs, whatever path leads to it, and no
// two outputs may be one file. Everything that reads a file by its path enters it here, and everything that writes one
// asks here, so that no verb needs to.
//
// A database of a server is entered as a store, and its atlases as such: two URIs of it are one database where their
// texts tell (DatabaseOfServer). It is no output without the name of an atlas.
//
// What SQLite keeps beside a store (`-wal`, `-shm`, `-journal`) is a part of it, and never an output.
//
// One list for the process. Nothing is entered or refused before KeepInputs(): a program may well save over what it
// loaded. Devices, pipes and terminals are no files here. Thread-safe.

// Whether the file is an SQLite database, also one in its first save, which lies in its log alone.
bool IsDatabase(const std::string& path);

// The log beside a database of this name that SQLite would play into it when it is opened: one that is not empty, of
// this database or of one that was removed. Empty: there is none.
std::string LogOfDatabase(const std::string& database);

// For a new database: throws Error (kAlreadyExists) when the log of one that is gone lies where it is to be.
SLAMDB_EXPORT void RefuseLogOfAnother(const std::string& place);

// From now on.
SLAMDB_EXPORT void KeepInputs();

// Whether two paths lead to one file, there or not, and both to the whole of it or to one atlas in it.
SLAMDB_EXPORT bool IsSameFile(const std::string& path, const AtlasName& atlas, const std::string& other,
                              const AtlasName& other_atlas);

// A file is read, or about to be.
SLAMDB_EXPORT void EnterInput(const std::string& path, const AtlasName& atlas = std::nullopt);

// Of an atlas that was entered as an input it is this revision that is read. It stays whatever is saved under the name.
SLAMDB_EXPORT void EnterRevision(const std::string& path, const std::string& atlas, const std::string& revision);

// Throws Error (kUsage) when the file is an input, or holds one.
SLAMDB_EXPORT void RefuseInput(const std::string& path, const AtlasName& atlas = std::nullopt);

// A file is written from now on. Throws Error (kUsage) as RefuseInput does, and when another output is the same file.
void EnterOutput(const std::string& path, const AtlasName& atlas = std::nullopt);

// Whether the file is one that this run reads or writes.
bool IsOfThisRun(const std::string& path);

// An output is in place, and may have become another file than the one that was there.
void EnterPlaced(const std::string& path);

}  // namespace slamdb::detail
