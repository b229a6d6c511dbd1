// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plain_sqlite.h"

#include <memory>

#include "slamdb/base/error.h"

namespace slamdb::bench {
namespace {

struct Closer {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Closer>;
using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

Database Open(const std::string& path, int flags) {
  sqlite3* database = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &database, flags, nullptr);
  Database opened(database);
  if (code != SQLITE_OK) throw Error(ErrorKind::kInternal, path, "", sqlite3_errstr(code));
  return opened;
}

Statement Prepare(const Database& database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    throw Error(ErrorKind::kInternal, sql + ": " + sqlite3_errmsg(database.get()));
  return Statement(statement);
}

bool Step(const Database& database, const Statement& statement) {
  const int code = sqlite3_step(statement.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) throw Error(ErrorKind::kInternal, sqlite3_errmsg(database.get()));
  return code == SQLITE_ROW;
}

void Run(const Database& database, const std::string& sql) { Step(database, Prepare(database, sql)); }

std::string Text(const Statement& statement, int column) {
  return reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
}

}  // namespace

SqliteTables::SqliteTables(const std::string& path) {
  const Database database = Open(path, SQLITE_OPEN_READONLY);
  const Statement names = Prepare(database,
                                  "SELECT name, sql FROM sqlite_schema JOIN pragma_table_list(name) USING (name) "
                                  "WHERE pragma_table_list.type = 'table' AND name NOT LIKE 'sqlite_%'");
  while (Step(database, names)) {
    Table& table = tables_.emplace_back();
    table.name = Text(names, 0);
    table.sql = Text(names, 1);
    const Statement rows = Prepare(database, "SELECT * FROM " + table.name);
    table.columns = sqlite3_column_count(rows.get());
    while (Step(database, rows))
      for (int column = 0; column < table.columns; ++column)
        table.values.push_back(sqlite3_value_dup(sqlite3_column_value(rows.get(), column)));
  }
}

void SqliteTables::Insert(const std::string& path) const {
  const Database database = Open(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  Run(database, "PRAGMA synchronous = OFF");
  Run(database, "BEGIN");
  for (const Table& table : tables_) {
    Run(database, table.sql);
    std::string sql = "INSERT INTO " + table.name + " VALUES (?";
    for (int column = 1; column < table.columns; ++column) sql += ", ?";
    const Statement insert = Prepare(database, sql + ")");
    for (auto value = table.values.begin(); value != table.values.end();) {
      for (int column = 1; column <= table.columns; ++column) sqlite3_bind_value(insert.get(), column, *value++);
      Step(database, insert);
      sqlite3_reset(insert.get());
    }
  }
  Run(database, "COMMIT");
}

}  // namespace slamdb::bench
