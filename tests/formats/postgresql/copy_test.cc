// SPDX-License-Identifier: BSD-3-Clause
// Rows in bulk, into a server and out of it.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <stdexcept>

#include "slamdb/formats/postgresql/detail/copy_in.h"
#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::postgresql {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CopyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    connection_.emplace(PostgresqlServer::Shared().Uri(PostgresqlServer::Shared().MakeDatabase()));
  }
  Connection& connection() { return *connection_; }
  std::int64_t Rows() { return connection().Integer("SELECT count(*) FROM t"); }

 private:
  std::optional<Connection> connection_;
};

TEST_F(CopyTest, EveryBitOfRealNumbersComesBack) {
  connection().Execute("CREATE TABLE t (id int, f4 float4, f8 float8)");
  const std::vector<std::uint32_t> bits = {0,           0x80000000U, 0x7fc00000U, 0xffc12345U, 0x7f800001U,
                                           0x7f800000U, 0xff800000U, 0x00000001U, 0x3dcccccdU};
  CopyIn in(connection(), "t (id, f4, f8)", {Type::kInt4, Type::kFloat4, Type::kFloat8});
  for (std::size_t i = 0; i < bits.size(); ++i) {
    in.Begin();
    in.Put(static_cast<std::int64_t>(i));
    in.PutReal32(std::bit_cast<float>(bits[i]));
    in.Put(std::bit_cast<double>(std::uint64_t{bits[i]} << 32U | 5U));
    in.End();
  }
  EXPECT_EQ(in.Finish(), static_cast<std::int64_t>(bits.size()));
  std::size_t i = 0;
  connection().CopyOut("SELECT f4, f8 FROM t ORDER BY id", [&](const Row& row) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(row.Real32(0)), bits[i]);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(row.Real(1)), std::uint64_t{bits[i]} << 32U | 5U);
    ++i;
  });
  EXPECT_EQ(i, bits.size());
}

TEST_F(CopyTest, EveryTypeComesBackAndEmptyIsNotNull) {
  connection().Execute(
      "CREATE TABLE t (b bool, i2 int2, i4 int4, i8 int8, f float4, s text, x bytea, u uuid, "
      "a8 int8[], a4 int4[])");
  const std::vector<Type> types = {Type::kBool, Type::kInt2,  Type::kInt4, Type::kInt8,      Type::kFloat4,
                                   Type::kText, Type::kBytea, Type::kUuid, Type::kInt8Array, Type::kInt4Array};
  CopyIn in(connection(), "t (b, i2, i4, i8, f, s, x, u, a8, a4)", types);
  const std::array<std::byte, 16> uuid = {std::byte{7}};
  in.Begin();
  for (const Value& value :
       {Value(std::int64_t{1}), Value(std::int64_t{-32768}), Value(std::int64_t{-5}), Value(std::int64_t{1} << 62),
        Value(std::nan("")), Value(std::string_view()), Value(Bytes()), Value(Bytes(uuid))})
    in.Put(value);
  in.Put(std::vector<std::int64_t>{1, -2});
  in.Put(std::vector<std::int32_t>{});
  in.End();
  in.Add(std::vector<Value>(types.size()));
  EXPECT_EQ(in.Finish(), 2);
  int rows = 0;
  connection().CopyOut("SELECT * FROM t ORDER BY b NULLS LAST", [&](const Row& row) {
    for (std::size_t column = 0; column < types.size(); ++column) EXPECT_EQ(row.IsNull(column), rows == 1) << column;
    if (++rows == 2) return;
    EXPECT_THAT((std::array{row.Integer(0), row.Integer(1), row.Integer(2), row.Integer(3)}),
                ElementsAre(1, -32768, -5, std::int64_t{1} << 62));
    EXPECT_TRUE(std::isnan(row.Real(4)) && row.Text(5).empty() && row.Blob(6).empty());
    EXPECT_TRUE(std::ranges::equal(row.Blob(7), uuid));
    std::vector<std::int64_t> longs;
    std::vector<std::int32_t> ints;
    row.Integers64(8, longs);
    row.Integers32(9, ints);
    EXPECT_THAT(longs, ElementsAre(1, -2));
    EXPECT_THAT(ints, ElementsAre());
  });
  EXPECT_EQ(rows, 2);
}

TEST_F(CopyTest, RowsOfManyMegabytesComeBack) {
  connection().Execute("CREATE TABLE t (id int8, x bytea)");
  std::string large(20'000'000, '\0');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i * 7 / 3);
  CopyIn in(connection(), "t (id, x)", {Type::kInt8, Type::kBytea});
  constexpr std::int64_t kRows = 200'000;
  for (std::int64_t id = 0; id < kRows; ++id)
    in.Add(std::array{Value(id), id == 77 ? Value(std::as_bytes(std::span(large))) : Value()});
  EXPECT_EQ(in.Finish(), kRows);
  std::int64_t sum = 0;
  connection().CopyOut("SELECT id, x FROM t", [&](const Row& row) {
    sum += row.Integer(0);
    EXPECT_EQ(row.Text(1) == large, row.Integer(0) == 77);
  });
  EXPECT_EQ(sum, kRows * (kRows - 1) / 2);
}

TEST_F(CopyTest, OfNothingThereIsNothing) {
  connection().Execute("CREATE TABLE t (id int8)");
  EXPECT_EQ(CopyIn(connection(), "t (id)", {Type::kInt8}).Finish(), 0);
  connection().CopyOut("SELECT id FROM t", [](const Row&) { FAIL(); });
  int rows = 0;
  connection().CopyOut("SELECT FROM generate_series(1, 3)",
                       [&](const Row& row) { rows += row.columns() == 0 ? 1 : 0; });
  EXPECT_EQ(rows, 3);
}

TEST_F(CopyTest, WhatAVisitThrowsComesThroughAndTheConnectionGoesOn) {
  for (const int last : {1, 1000}) {
    int rows = 0;
    const auto visit = [&](const Row&) {
      if (++rows == last) throw std::runtime_error("enough");
    };
    EXPECT_THROW(connection().CopyOut("SELECT generate_series(1, 1000000000)", visit), std::runtime_error);
    EXPECT_EQ(rows, last);
    EXPECT_EQ(connection().Integer("SELECT 7"), 7);
  }
  connection().Execute("CREATE SCHEMA slamdb");
  Transaction transaction(connection(), Transaction::Kind::kRead);
  const auto stop = [](const Row&) { throw std::runtime_error("enough"); };
  EXPECT_THROW(connection().CopyOut("SELECT 1 FROM generate_series(1, 3)", stop), std::runtime_error);
}

TEST_F(CopyTest, AStatementThatFailsOnTheWayIsAnError) {
  std::int64_t rows = 0;
  const Error error = ErrorOf([&] {
    connection().CopyOut(
        "SELECT 1 / (5000 - id) FROM generate_series(1, 10000) id", [&](const Row&) { ++rows; }, "table t");
  });
  EXPECT_EQ(rows, 4999);
  EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
  EXPECT_EQ(error.place(), "table t");
  EXPECT_EQ(KindOf([&] { connection().CopyOut("SELECT * FROM missing", [](const Row&) {}); }), ErrorKind::kNotFound);
  EXPECT_EQ(connection().Integer("SELECT 7"), 7);
}

TEST_F(CopyTest, WithoutFinishNothingIsThere) {
  connection().Execute("CREATE TABLE t (id int8)");
  {
    CopyIn in(connection(), "t (id)", {Type::kInt8});
    for (std::int64_t id = 0; id < 300'000; ++id) in.Add(std::array{Value(id)});
  }
  EXPECT_EQ(Rows(), 0);
  EXPECT_THROW(
      {
        CopyIn in(connection(), "t (id)", {Type::kInt8});
        in.Add(std::array{Value(0.5)});
      },
      Error);
  EXPECT_EQ(Rows(), 0);
}

TEST_F(CopyTest, WhatTheServerRefusesIsAnErrorOfFinish) {
  connection().Execute("CREATE TABLE t (id int8 PRIMARY KEY, s text)");
  const auto copy = [&](std::string_view text, std::int64_t rows) {
    return ErrorOf([&] {
      CopyIn in(connection(), "t (id, s)", {Type::kInt8, Type::kText});
      for (std::int64_t id = 0; id < rows; ++id) in.Add(std::array{Value(id / 2), Value(text)});
      in.Finish();
    });
  };
  EXPECT_EQ(copy("same key", 2).kind(), ErrorKind::kDamaged);
  EXPECT_EQ(copy("long before its end", 1'000'000).kind(), ErrorKind::kDamaged);
  EXPECT_EQ(copy(std::string_view("a\0b", 3), 1).kind(), ErrorKind::kNotPossible);
  EXPECT_EQ(copy("\xff", 1).place(), "table t");
  EXPECT_EQ(KindOf([&] { CopyIn(connection(), "missing (id)", {Type::kInt8}); }), ErrorKind::kNotFound);
  EXPECT_EQ(Rows(), 0);
}

TEST_F(CopyTest, AServerThatIsKilledInTheMiddleSaysToTryAgain) {
  PostgresqlServer server;
  const std::string uri = server.Uri(server.MakeDatabase());
  Connection(uri).Execute("CREATE TABLE t (id int8)");
  const auto is_lost = [](const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kLocked) << error.what();
    EXPECT_THAT(error.problem(), HasSubstr("try again"));
  };
  Connection writer(uri);
  is_lost(ErrorOf([&] {
    CopyIn in(writer, "t (id)", {Type::kInt8});
    for (std::int64_t id = 0; id < 1'000'000; ++id) {
      in.Add(std::array{Value(id)});
      if (id == 200'000) server.Kill();
    }
    in.Finish();
  }));
  EXPECT_TRUE(writer.is_lost());
  server.Start();
  Connection reader(uri);
  EXPECT_EQ(reader.Integer("SELECT count(*) FROM t"), 0);
  int rows = 0;
  is_lost(ErrorOf([&] {
    reader.CopyOut("SELECT generate_series(1, 1000000000)", [&](const Row&) {
      if (++rows == 1000) server.Kill();
    });
  }));
  EXPECT_GE(rows, 1000);
}

}  // namespace
}  // namespace slamdb::postgresql
