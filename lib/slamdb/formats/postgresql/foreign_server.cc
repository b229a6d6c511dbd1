// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/foreign_server.h"

#include <set>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/connect.h"
#include "slamdb/formats/postgresql/detail/schema.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

// `a 'x', b 'y'`, as SQL, which the server quotes.
std::string OptionsSql(Connection& connection, const Options& options, std::string_view action = {}) {
  std::vector<std::string> names, values;
  for (const auto& [name, value] : options) {
    names.push_back(name);
    values.push_back(value);
  }
  const Result found = connection.Query(
      Concat("SELECT coalesce(string_agg(format('", action,
             " %I %L', name, value), ', '), '') FROM unnest($1::text[], $2::text[]) AS option (name, value)"),
      {std::span<const std::string>(names), std::span<const std::string>(values)});
  return std::string(found[0].Text(0));
}

Options ReadOptions(Connection& connection, std::string_view from, const std::string& name) {
  const Result found = connection.Query(
      Concat("SELECT option_name, coalesce(option_value, '') FROM ", from, " WHERE srvname = $1"), {name});
  Options options;
  for (std::size_t i = 0; i < found.rows(); ++i)
    options.emplace(std::string(found[i].Text(0)), std::string(found[i].Text(1)));
  return options;
}

void CreateMapping(Connection& connection, const std::string& name, const ForeignServer& server) {
  Options mapping = server.mapping;
  // Without password the server's own way is taken (trust, peer, certificate, the .pgpass of its system user), which
  // only a superuser may allow for others.
  if (!mapping.contains("password") &&
      connection.Integer("SELECT rolsuper FROM pg_roles WHERE rolname = current_user") != 0)
    mapping["password_required"] = "false";
  connection.Execute(
      Concat("CREATE USER MAPPING FOR PUBLIC SERVER ", name, " OPTIONS (", OptionsSql(connection, mapping), ")"));
}

}  // namespace

std::string ForeignServer::Label() const {
  const auto of = [&](const char* name) {
    const auto found = options.find(name);
    return found == options.end() ? std::string() : found->second;
  };
  return Concat(of("host"), ":", of("port"), "/", of("dbname"));
}

std::string NameOfServer(std::int64_t partition) { return Concat("slamdb_", partition); }

ForeignServer ForeignServerOf(const Connection& remote, const std::string& uri) {
  static const std::set<std::string> kOfUser = {"user", "password", "sslpassword"};
  static const std::set<std::string> kNotTaken = {"client_encoding", "application_name", "fallback_application_name",
                                                  "replication", "options"};
  ForeignServer server;
  server.options = {{"async_capable", "true"}, {"batch_size", "1000"},    {"connect_timeout", "5"},
                    {"fetch_size", "1000"},    {"keepalives_idle", "30"}, {"keepalives_interval", "10"},
                    {"keepalives_count", "3"}};
  for (const auto& [name, value] : ParametersOf(remote, uri))
    if (!kNotTaken.contains(name)) (kOfUser.contains(name) ? server.mapping : server.options)[name] = value;
  return server;
}

std::optional<ForeignServer> ReadForeignServer(Connection& connection, const std::string& name) {
  if (connection.Integer("SELECT count(*) FROM pg_foreign_server WHERE srvname = $1", {name}) == 0) return std::nullopt;
  return ForeignServer{
      ReadOptions(connection, "pg_foreign_server, pg_options_to_table(srvoptions)", name),
      ReadOptions(connection, "pg_user_mappings CROSS JOIN LATERAL pg_options_to_table(umoptions)", name)};
}

void CreateForeignServer(Connection& connection, const std::string& name, const ForeignServer& server) {
  connection.Execute(Concat("CREATE SERVER ", name, " FOREIGN DATA WRAPPER postgres_fdw OPTIONS (",
                            OptionsSql(connection, server.options), ")"));
  CreateMapping(connection, name, server);
}

void AlterForeignServer(Connection& connection, const std::string& name, const ForeignServer& before,
                        const ForeignServer& after) {
  Options added, changed;
  std::string dropped;
  for (const auto& [option, value] : after.options) (before.options.contains(option) ? changed : added)[option] = value;
  for (const auto& [option, value] : before.options)
    if (!after.options.contains(option)) dropped += Concat(dropped.empty() ? "" : ", ", "DROP ", option);
  std::string all = OptionsSql(connection, changed, "SET");
  for (const std::string& more : {OptionsSql(connection, added, "ADD"), dropped})
    if (!more.empty()) all += Concat(all.empty() ? "" : ", ", more);
  connection.Execute(Concat("ALTER SERVER ", name, " OPTIONS (", all, ")"));
  connection.Execute(Concat("DROP USER MAPPING FOR PUBLIC SERVER ", name));
  CreateMapping(connection, name, after);
}

std::string_view OptionsOfTable(std::string_view table) {
  if (table == "picture") return "batch_size '16', fetch_size '64'";
  if (table == "keyframe_features" || table == "keyframe") return "batch_size '100', fetch_size '500'";
  return {};
}

void CreateForeignPartition(Connection& connection, std::string_view table, std::int64_t partition,
                            std::int64_t partitions) {
  const std::string_view more = OptionsOfTable(table);
  connection.Execute(Concat("CREATE FOREIGN TABLE ", table, "_", partition, " PARTITION OF ", table,
                            " FOR VALUES WITH (MODULUS ", partitions, ", REMAINDER ", partition, ") SERVER ",
                            NameOfServer(partition), " OPTIONS (schema_name 'slamdb', table_name '", table, "_",
                            partition, "'", more.empty() ? "" : ", ", more, ")"));
}

void OpenDoor(Connection& connection, const std::string& name, const ForeignServer& server, std::int64_t partition) {
  CreateForeignServer(connection, name, server);
  connection.Execute(Concat("CREATE SCHEMA ", name));
  std::string tables;
  for (const std::string_view table : PartitionedTables())
    tables += Concat(tables.empty() ? "" : ", ", table, "_", partition);
  connection.Execute(Concat("IMPORT FOREIGN SCHEMA slamdb LIMIT TO (", tables, ") FROM SERVER ", name, " INTO ", name,
                            " OPTIONS (import_not_null 'false')"));
  for (const std::string_view table : PartitionedTables())
    if (const std::string_view more = OptionsOfTable(table); !more.empty())
      connection.Execute(Concat("ALTER FOREIGN TABLE ", name, ".", table, "_", partition, " OPTIONS (", more, ")"));
}

void CloseDoor(Connection& connection, const std::string& name) {
  connection.Execute(Concat("DROP SCHEMA ", name, " CASCADE"));
  connection.Execute(Concat("DROP SERVER ", name, " CASCADE"));
}

}  // namespace slamdb::postgresql
