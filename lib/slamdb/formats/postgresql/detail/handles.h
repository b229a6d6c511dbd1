// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <libpq-fe.h>

#include <cstdint>
#include <memory>

// libpq's handles, for those sources that are left out without it.
namespace slamdb::postgresql {

struct ClearResult {
  void operator()(PGresult* result) const { PQclear(result); }
};
using ResultHandle = std::unique_ptr<PGresult, ClearResult>;

struct FinishConnection {
  void operator()(PGconn* connection) const { PQfinish(connection); }
};

// Takes all results that are still to come, so that the connection can go on.
void Drain(PGconn* connection);

// How many rows a statement changed; 0 when that means nothing.
std::int64_t ChangedRows(PGresult* result);

}  // namespace slamdb::postgresql
