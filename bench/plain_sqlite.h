// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sqlite3.h>

#include <string>
#include <vector>

namespace slamdb::bench {

// All rows of the tables of a store, in memory: what a program that is not more than SQLite reads and writes of it.
// Without virtual tables and what stands behind them.
class SqliteTables {
 public:
  // Reads them. Throws Error.
  explicit SqliteTables(const std::string& path);

  // Into a new database, in one transaction and unsynced: no indexes but keys, no triggers, no foreign keys checked.
  void Insert(const std::string& path) const;

 private:
  struct Table {
    std::string name, sql;
    int columns = 0;
    std::vector<sqlite3_value*> values;  // row after row; the process ends with them
  };

  std::vector<Table> tables_;
};

}  // namespace slamdb::bench
