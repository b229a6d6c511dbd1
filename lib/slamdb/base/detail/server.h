// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "slamdb/export.h"

// Locations that are databases of a server, as libpq's URIs name them:
// `postgresql://user@host:5432/database?sslmode=...`.
namespace slamdb::detail {

// True of what begins with `postgresql://` or `postgres://`.
SLAMDB_EXPORT bool IsServer(std::string_view path);

// Where the first URI in a text begins, from a byte on; npos: there is none.
std::size_t FindUri(std::string_view text, std::size_t from = 0);

// Where `#name` begins behind the URI of a server: at its last `#`; npos: nowhere. One in a password, where it should
// be percent-encoded, is none.
std::size_t NameBehind(std::string_view uri);

// The URI without what nobody may read: the password of `user:password@`, and the parameters that hold one
// (`password=`, `sslpassword=` and the like). Everything else stays, byte for byte; so does what is no such URI.
//
// A password with `@` or `/` that are not percent-encoded goes, too, though libpq would take it for something else; and
// so does one behind a scheme that is mistyped (`postgresql:/user:password@host`, `pg://user:password@host`).
SLAMDB_EXPORT std::string WithoutPassword(std::string_view uri);

// What libpq takes besides URIs, `host=lab password=x`, which is no location here: with `...` for the password. All
// else stays as it is.
SLAMDB_EXPORT std::string WithoutKeywordPasswords(std::string words);

// A whole text, without the passwords of the URIs in it, which end at blanks and double quotes.
SLAMDB_EXPORT std::string WithoutPasswords(std::string text);

// How the database is called; empty: the URI does not tell.
SLAMDB_EXPORT std::string NameOfDatabase(std::string_view uri);

// Which database a URI leads to, as far as its text tells: hosts with ports, and the name of the database. Users,
// passwords and other parameters do not count.
std::string DatabaseOfServer(std::string_view uri);

// Throws Error (kUsage) for what was probably meant to be the URI of a server and is none, as `postgresql:/host/maps`
// or `postgres:maps`, unless there is a file of that name.
SLAMDB_EXPORT void RefuseMistypedServer(const std::string& path);

// Throws Error (kUsage) for a server, which stands where a file is read or written.
SLAMDB_EXPORT void RequireFile(const std::string& path);

// Throws Error (kNotPossible) for a server, with what does there what was asked for.
SLAMDB_EXPORT void RefuseOnServer(const std::string& path, std::string_view instead);

}  // namespace slamdb::detail
