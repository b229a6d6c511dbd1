// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/postgresql/detail/connection.h"

namespace slamdb::postgresql {

// A connection that stands, to be given to PQfinish. `path` is the URI without password. Throws as Connection does.
pg_conn* Connect(const std::string& uri, const std::string& path, const ConnectionOptions& options);

}  // namespace slamdb::postgresql
