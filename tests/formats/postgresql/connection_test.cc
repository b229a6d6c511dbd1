// SPDX-License-Identifier: BSD-3-Clause
// Statements, their parameters and results, transactions.
#include "slamdb/formats/postgresql/detail/connection.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::postgresql {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ConnectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    uri_ = PostgresqlServer::Shared().Uri(PostgresqlServer::Shared().MakeDatabase());
  }
  std::string uri_;
};

TEST_F(ConnectionTest, ParametersComeBackAsTheyWere) {
  Connection connection(uri_);
  const Uuid uuid = {std::byte{1}, std::byte{0xff}};
  const std::string binary("\0\xff\n", 3);
  const Result result = connection.Query(
      "SELECT $1, $2, $3, $4, $5, $6, $7::int4, $8::int2, $9",
      {std::int64_t{-1} << 40, 0.1, "tëxt", std::as_bytes(std::span(binary)), uuid, true, 5, -6, Parameter::Null()});
  ASSERT_EQ(result.rows(), 1U);
  const Row row = result[0];
  EXPECT_EQ(row.columns(), 9U);
  EXPECT_EQ(row.Integer(0), std::int64_t{-1} << 40);
  EXPECT_EQ(row.Real(1), 0.1);
  EXPECT_EQ(row.Text(2), "tëxt");
  EXPECT_TRUE(std::ranges::equal(row.Blob(3), std::as_bytes(std::span(binary))));
  EXPECT_TRUE(std::ranges::equal(row.Blob(4), uuid));
  EXPECT_EQ(row.Integer(5), 1);
  EXPECT_EQ(row.Integer(6), 5);
  EXPECT_EQ(row.Integer(7), -6);
  EXPECT_TRUE(row.IsNull(8));
}

TEST_F(ConnectionTest, ArraysComeBackAsTheyWere) {
  Connection connection(uri_);
  const std::vector<std::int64_t> longs = {1, std::int64_t{-1} << 62, 0}, none;
  const std::vector<std::int32_t> ints = {7, -8};
  const Result result = connection.Query(
      "SELECT $1, $2, $3",
      {std::span<const std::int64_t>(longs), std::span<const std::int32_t>(ints), std::span<const std::int64_t>(none)});
  std::vector<std::int64_t> first, third;
  std::vector<std::int32_t> second;
  result[0].Integers64(0, first);
  result[0].Integers32(1, second);
  result[0].Integers64(2, third);
  EXPECT_EQ(first, longs);
  EXPECT_EQ(second, ints);
  EXPECT_THAT(third, ElementsAre());
  EXPECT_EQ(KindOf([&] { result[0].Integers32(0, second); }), ErrorKind::kDamaged);
  const Result odd = connection.Query("SELECT ARRAY[1, NULL]::int8[], ARRAY[[1, 2], [3, 4]]::int8[], NULL::int8[]");
  EXPECT_EQ(KindOf([&] { odd[0].Integers64(0, first); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { odd[0].Integers64(1, first); }), ErrorKind::kDamaged);
  odd[0].Integers64(2, third);
  EXPECT_THAT(third, ElementsAre());
}

TEST_F(ConnectionTest, RowsAreFoundByArraysOfKeys) {
  Connection connection(uri_);
  connection.Execute("CREATE TABLE t (id int, name text, hash bytea, key uuid)");
  const std::vector<Uuid> uuids = {Uuid{std::byte{1}}, Uuid{std::byte{2}}};
  const std::vector<std::string> names = {"a", "", "c, \"d\""};
  const std::string blob("\0x", 2);
  const std::vector<Bytes> blobs = {std::as_bytes(std::span(blob)), Bytes()};
  for (int i = 0; i < 3; ++i)
    connection.Query("INSERT INTO t VALUES ($1, $2, $3, $4)", {i, names[i], blobs[i % 2], uuids[i % 2]});
  const auto found = [&](const std::string& where, const Parameter& keys) {
    return connection.Integer("SELECT count(*) FROM t WHERE " + where, {keys});
  };
  EXPECT_EQ(found("key = ANY($1)", std::span<const Uuid>(uuids)), 3);
  EXPECT_EQ(found("name = ANY($1)", std::span<const std::string>(names)), 3);
  EXPECT_EQ(found("hash = ANY($1)", std::span<const Bytes>(blobs).first(1)), 2);
  EXPECT_EQ(found("hash = ANY($1)", std::span<const Bytes>()), 0);
  EXPECT_EQ(connection.Query("UPDATE t SET id = 9 WHERE id > $1", {0}).changed(), 2);
  EXPECT_EQ(connection.Integer("SELECT id FROM t WHERE id = 77"), 0);
}

TEST_F(ConnectionTest, TheServerIsToldWhoItIs) {
  Connection connection(uri_);
  const Result result =
      connection.Query("SELECT current_setting('application_name'), current_setting('client_encoding')");
  EXPECT_THAT(std::string(result[0].Text(0)), ::testing::MatchesRegex("slamdb [0-9.]+ .+@.+"));
  EXPECT_EQ(result[0].Text(1), "UTF8");
  Connection named(uri_ + "&application_name=robot");
  EXPECT_EQ(named.Query("SELECT current_setting('application_name')")[0].Text(0), "robot");
}

TEST_F(ConnectionTest, ErrorsHaveStateAndPlaceAndLeaveItUsable) {
  Connection connection(uri_);
  EXPECT_THAT(ErrorOf([&] { connection.Execute("SELEKT"); }).problem(), HasSubstr("SELEKT"));
  connection.Execute("CREATE TABLE t (id int PRIMARY KEY); INSERT INTO t VALUES (4711)");
  try {
    connection.Query("INSERT INTO t VALUES ($1)", {4711}, "table t");
    FAIL();
  } catch (const ServerError& error) {
    EXPECT_EQ(error.state(), "23505");
    EXPECT_EQ(error.place(), "table t");
    EXPECT_THAT(error.problem(), HasSubstr("4711"));
  }
  EXPECT_EQ(KindOf([&] { connection.Query("SELECT * FROM missing"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { connection.Query("SELECT 1 FROM t")[1]; }), ErrorKind::kInternal);
  EXPECT_EQ(connection.Integer("SELECT count(*) FROM t"), 1);
  EXPECT_FALSE(connection.is_lost());
}

TEST_F(ConnectionTest, TransactionsAreTakenBackUnlessCommitted) {
  Connection connection(uri_), other(uri_);
  connection.Execute("CREATE SCHEMA slamdb; CREATE TABLE slamdb.t (id int)");
  const auto rows = [&] { return other.Integer("SELECT count(*) FROM slamdb.t"); };
  {
    const Transaction transaction(connection, Transaction::Kind::kWrite);
    connection.Execute("INSERT INTO t VALUES (1)");
  }
  EXPECT_EQ(rows(), 0);
  Transaction transaction(connection, Transaction::Kind::kWrite);
  connection.Execute("INSERT INTO t VALUES (1)");
  EXPECT_EQ(rows(), 0);
  transaction.Commit();
  EXPECT_EQ(rows(), 1);
  EXPECT_EQ(KindOf([&] { connection.Execute("INSERT INTO t VALUES (1)"); }), ErrorKind::kNotFound);  // no search path
}

TEST_F(ConnectionTest, ACommitThatIsNoneIsAnError) {
  Connection connection(uri_);
  Transaction transaction(connection, Transaction::Kind::kWrite);
  connection.Execute("CREATE SCHEMA slamdb");
  EXPECT_EQ(KindOf([&] { connection.Execute("SELECT 1 / 0"); }), ErrorKind::kNotPossible);
  EXPECT_THAT(ErrorOf([&] { transaction.Commit(); }).problem(), HasSubstr("nothing was saved"));
  EXPECT_EQ(connection.Integer("SELECT count(*) FROM pg_namespace WHERE nspname = 'slamdb'"), 0);
}

TEST_F(ConnectionTest, ReadersSeeOneStateAndCannotWrite) {
  Connection reader(uri_), writer(uri_);
  writer.Execute("CREATE SCHEMA slamdb; CREATE TABLE slamdb.t (id int)");
  const Transaction transaction(reader, Transaction::Kind::kRead);
  EXPECT_EQ(reader.Integer("SELECT count(*) FROM t"), 0);
  writer.Execute("INSERT INTO slamdb.t VALUES (1)");
  EXPECT_EQ(reader.Integer("SELECT count(*) FROM t"), 0);
  EXPECT_EQ(KindOf([&] { reader.Execute("INSERT INTO t VALUES (1)"); }), ErrorKind::kPermission);
}

TEST_F(ConnectionTest, WhatOthersHoldIsLocked) {
  Connection holder(uri_), other(uri_);
  holder.Execute("CREATE SCHEMA slamdb; CREATE TABLE slamdb.t (id int)");
  const Transaction first(holder, Transaction::Kind::kWrite);
  holder.Execute("LOCK TABLE t");
  const Transaction second(other, Transaction::Kind::kWrite);
  try {
    other.Execute("LOCK TABLE t NOWAIT");
    FAIL();
  } catch (const ServerError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kLocked);
    EXPECT_TRUE(IsWorthRetrying(error));
  }
}

TEST_F(ConnectionTest, WhoMayNotDoItIsTold) {
  const std::string role = "guest" + std::to_string(::testing::UnitTest::GetInstance()->random_seed());
  Connection owner(uri_);
  owner.Execute("CREATE TABLE t (id int); DROP ROLE IF EXISTS " + role + "; CREATE ROLE " + role);
  owner.Execute("SET ROLE " + role);
  const Error error = ErrorOf([&] { owner.Query("SELECT * FROM t"); });
  EXPECT_EQ(error.kind(), ErrorKind::kPermission);
  EXPECT_THAT(error.problem(), HasSubstr("GRANT"));
}

TEST_F(ConnectionTest, NamesOfTheServerCannotSteerATerminal) {
  Connection connection(uri_);
  const std::string problem = ErrorOf([&] { connection.Query("SELECT * FROM \"a\x1b[31m\""); }).problem();
  EXPECT_THAT(problem, HasSubstr("a\\e[31m"));
}

TEST_F(ConnectionTest, AServerThatIsKilledIsLostAndWorthTryingAgain) {
  PostgresqlServer server;
  const std::string uri = server.Uri(server.MakeDatabase());
  Connection connection(uri);
  connection.Execute("CREATE SCHEMA slamdb; CREATE TABLE slamdb.t (id int)");
  {
    Transaction transaction(connection, Transaction::Kind::kWrite);
    connection.Execute("INSERT INTO t VALUES (1)");
    server.Kill();
    try {
      transaction.Commit();
      FAIL();
    } catch (const ServerError& error) {
      EXPECT_TRUE(IsWorthRetrying(error)) << error.what();
      EXPECT_THAT(error.problem(), HasSubstr("try again"));
    }
    EXPECT_TRUE(connection.is_lost());
    EXPECT_THROW(connection.Query("SELECT 1"), ServerError);
  }
  server.Start();
  EXPECT_EQ(Connection(uri).Integer("SELECT count(*) FROM slamdb.t"), 0);
}

TEST_F(ConnectionTest, AServerThatIsStoppedSaysSo) {
  PostgresqlServer server;
  Connection connection(server.Uri("postgres"));
  server.Stop();
  const Error error = ErrorOf([&] { connection.Execute("SELECT 1"); });
  EXPECT_EQ(error.kind(), ErrorKind::kLocked);
  EXPECT_THAT(error.problem(), HasSubstr("try again; what was being saved is there whole, or not at all"));
}

}  // namespace
}  // namespace slamdb::postgresql
