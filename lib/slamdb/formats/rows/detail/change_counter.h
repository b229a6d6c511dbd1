// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "slamdb/formats/rows/stored.h"

namespace slamdb::rows {

// Counts what happens to the rows of each table.
class ChangeCounter {
 public:
  TableChanges& operator[](const std::string& table) {
    for (TableChanges& changes : tables_)
      if (changes.table == table) return changes;
    return tables_.emplace_back(TableChanges{.table = table});
  }
  std::vector<TableChanges> Take() const { return {tables_.begin(), tables_.end()}; }

 private:
  std::deque<TableChanges> tables_;  // so that references stay valid
};

}  // namespace slamdb::rows
