// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/export.h"

// What a file is by its bytes, whoever wanted to read it. Every input that is refused says what it is by this.
namespace slamdb::detail {

struct Recognized {
  std::string_view id;  // `git-lfs`, `zip`, `vocabulary`, ...
  ErrorKind kind;
  std::string what;  // `a Git LFS pointer that stands for the file`
  std::string next;  // what to do about it; may be empty
};

// Whether a file that begins so is an SQLite database.
bool IsSqlite(std::string_view head);

// nullopt when nothing is known about it. Reads on in files of which the first bytes say too little.
SLAMDB_EXPORT std::optional<Recognized> Recognize(const Probe& probe);

// What is said of files that Recognize() gives that id: for folders that are told by the name of such a file.
SLAMDB_EXPORT Recognized RecognizedAs(std::string_view id);

// `not an atlas: this is a Git LFS pointer that stands for the file; fetch the file itself (git lfs pull)`.
SLAMDB_EXPORT std::string SentenceOf(const Recognized& recognized, std::string_view wanted);

// Throws Error when the bytes are known to be something else than what was wanted (`a journal`), and than what `takes`
// lists.
SLAMDB_EXPORT void RefuseOther(const Probe& probe, std::string_view wanted,
                               std::initializer_list<std::string_view> takes = {});

// For files that go into or beside an output that was named: throws Error (kAlreadyExists) when an atlas or an SQLite
// database is there, which only one that was meant replaces.
SLAMDB_EXPORT void RefuseReplacingMap(const std::string& path);

}  // namespace slamdb::detail
