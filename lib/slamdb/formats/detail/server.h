// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

// Locations that are databases of a server, as libpq's URIs name them:
// `postgresql://user@host:5432/database?sslmode=...`.
namespace slamdb::detail {

// True of what begins with `postgresql://` or `postgres://`.
bool IsServer(std::string_view path);

// The URI without what nobody may read: the password of `user:password@`, and the parameters that hold one
// (`password=`, `sslpassword=` and the like). Everything else stays, byte for byte; so does what is no such URI.
//
// A password with `@` or `/` that are not percent-encoded goes, too, though libpq would take it for something else.
std::string WithoutPassword(std::string_view uri);

}  // namespace slamdb::detail
