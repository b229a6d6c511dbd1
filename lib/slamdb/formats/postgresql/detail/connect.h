// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "slamdb/formats/postgresql/detail/connection.h"

namespace slamdb::postgresql {

// A connection that stands, to be given to PQfinish. `path` is the URI without password. Throws as Connection does.
pg_conn* Connect(const std::string& uri, const std::string& path, const ConnectionOptions& options);

// What libpq needs to connect there from another machine: the parameters of the URI, also its password, and host, port,
// dbname and user where it has none. `connection` is one that was made by that URI.
std::map<std::string, std::string> ParametersOf(const Connection& connection, const std::string& uri);

}  // namespace slamdb::postgresql
