// SPDX-License-Identifier: BSD-3-Clause
// Many rows at a time: put into a table, and visited.
#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "slamdb/formats/sqlite/detail/batch_insert.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using rows::Value;
using sqlite::BatchInsert;
using sqlite::Row;
using sqlite::Statement;

class StoreRows : public ::testing::Test {
 protected:
  StoreRows() { database_.Execute("CREATE TABLE t (n INTEGER PRIMARY KEY, r REAL, s TEXT, b BLOB) STRICT"); }
  void Visit(const std::function<void(const Row&)>& visit) {
    Statement select(database_, "SELECT slamdb_visit(?1, n, r, s, b) FROM t WHERE n BETWEEN ?2 AND ?3");
    VisitRows(select.Bind(2, std::int64_t{10}).Bind(3, std::int64_t{4999}), visit);
  }

  TemporaryFolder folder_;
  sqlite::Database database_{folder_ / "t.db", sqlite::Access::kCreate, 0};
};

TEST_F(StoreRows, ComeBackAsTheyWere) {
  BatchInsert insert(database_, "t", 4);
  const std::string text = "text";
  for (std::int64_t n = 0; n < 5000; ++n)
    insert.Add(std::array<Value, 4>{n, static_cast<double>(n) / 4, std::string_view(text).substr(0, n % 5),
                                    std::as_bytes(std::span(text)).subspan(0, n % 5)});
  insert.Flush();
  insert.Flush();
  EXPECT_EQ(database_.Integer("SELECT count(*) FROM t"), 5000);
  std::int64_t next = 10;
  Visit([&](const Row& row) {
    ASSERT_EQ(row.Integer(0), next);
    EXPECT_EQ(row.Real(1), static_cast<double>(next) / 4);
    EXPECT_EQ(row.Text(2), text.substr(0, next % 5));
    EXPECT_FALSE(row.IsNull(3));
    EXPECT_EQ(row.Blob(3).size(), next % 5);
    ++next;
  });
  EXPECT_EQ(next, 5000);
}

TEST_F(StoreRows, NothingAndNaNAreNull) {
  BatchInsert insert(database_, "t", 4);
  insert.Add(std::array<Value, 4>{std::int64_t{10}, std::numeric_limits<double>::quiet_NaN(), Value(), Value()});
  insert.Flush();
  int rows = 0;
  Visit([&](const Row& row) {
    for (int column = 1; column < 4; ++column) EXPECT_TRUE(row.IsNull(column)) << column;
    EXPECT_NE(row.Real(1), row.Real(1));
    ++rows;
  });
  EXPECT_EQ(rows, 1);
}

TEST_F(StoreRows, ARowThatIsThereTakesTheTransactionBack) {
  database_.Execute("BEGIN");
  BatchInsert insert(database_, "t", 4);
  for (const std::int64_t n : {1, 2, 3, 2}) insert.Add(std::array<Value, 4>{n, 0.0, Value(), Value()});
  EXPECT_THROW(insert.Flush(), Error);
  EXPECT_EQ(database_.Integer("SELECT count(*) FROM t"), 0);
}

TEST_F(StoreRows, WhatAVisitThrowsEndsIt) {
  database_.Execute("INSERT INTO t (n) VALUES (20), (21), (22)");
  int rows = 0;
  EXPECT_THROW(Visit([&](const Row&) {
                 ++rows;
                 throw std::out_of_range("enough");
               }),
               std::out_of_range);
  EXPECT_EQ(rows, 1);
}

}  // namespace
}  // namespace slamdb::store_test
