// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/formats/postgresql/detail/connection.h"

// Other servers as postgres_fdw knows them: one SERVER for each partition, so that one is moved by an ALTER SERVER,
// which locks no table.
namespace slamdb::postgresql {

using Options = std::map<std::string, std::string>;

struct ForeignServer {
  Options options;  // of CREATE SERVER
  Options mapping;  // of CREATE USER MAPPING: user and, where it was in the URI, password

  // `host:5432/database`
  std::string Label() const;
};

std::string NameOfServer(std::int64_t partition);  // `slamdb_3`

// The server that a URI leads to, by which `remote` was made. Other parameters of the URI are kept as well, but for
// those that postgres_fdw sets itself.
ForeignServer ForeignServerOf(const Connection& remote, const std::string& uri);
// Empty: there is none of that name.
std::optional<ForeignServer> ReadForeignServer(Connection& connection, const std::string& name);

// In the caller's transaction. Everybody comes to the server as the one user of `mapping`; what they may do say the
// rights on the foreign tables.
void CreateForeignServer(Connection& connection, const std::string& name, const ForeignServer& server);
void AlterForeignServer(Connection& connection, const std::string& name, const ForeignServer& before,
                        const ForeignServer& after);

// `OPTIONS (batch_size '16')` of tables with large rows; empty for the others.
std::string_view OptionsOfTable(std::string_view table);

// Makes the partition of a table that is on its server.
void CreateForeignPartition(Connection& connection, std::string_view table, std::int64_t partition,
                            std::int64_t partitions);

// The tables that a partition has on a server, beside the store's own: in a schema and with a SERVER of that name.
void OpenDoor(Connection& connection, const std::string& name, const ForeignServer& server, std::int64_t partition);
void CloseDoor(Connection& connection, const std::string& name);

}  // namespace slamdb::postgresql
