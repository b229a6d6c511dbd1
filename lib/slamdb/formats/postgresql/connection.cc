// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/connection.h"

#include <libpq-fe.h>

#include <cstdlib>
#include <string_view>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hidden_passwords.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/postgresql/detail/connect.h"
#include "slamdb/formats/postgresql/detail/encode.h"
#include "slamdb/formats/postgresql/detail/handles.h"

namespace slamdb::postgresql {
namespace {

constexpr int kBinary = 1;

std::string_view FieldOf(const PGresult* result, int field) {
  const char* text = PQresultErrorField(result, field);
  return text == nullptr ? std::string_view() : text;
}

// What the server says, with the values that it is about, and its hint.
std::string MessageOf(const PGresult* result) {
  std::string message(FieldOf(result, PG_DIAG_MESSAGE_PRIMARY));
  for (const int field : {PG_DIAG_MESSAGE_DETAIL, PG_DIAG_MESSAGE_HINT}) {
    const std::string_view text = FieldOf(result, field);
    if (!text.empty()) message += detail::Concat("; ", text);
  }
  return message;
}

}  // namespace

void Drain(PGconn* connection) {
  for (ResultHandle result(PQgetResult(connection)); result; result.reset(PQgetResult(connection))) {
    if (PQresultStatus(result.get()) == PGRES_COPY_IN) PQputCopyEnd(connection, "not wanted");
    char* bytes = nullptr;
    while (PQresultStatus(result.get()) == PGRES_COPY_OUT && PQgetCopyData(connection, &bytes, 0) > 0) PQfreemem(bytes);
    if (PQstatus(connection) == CONNECTION_BAD) return;
  }
}

std::int64_t ChangedRows(PGresult* result) { return std::strtoll(PQcmdTuples(result), nullptr, 10); }

void Result::Clear::operator()(pg_result* result) const { PQclear(result); }

Result::Result(pg_result* result, RowOrigin origin)
    : handle_(result),
      origin_(std::make_unique<const RowOrigin>(std::move(origin))),
      rows_(static_cast<std::size_t>(PQntuples(result))) {
  fields_.reserve(rows_ * static_cast<std::size_t>(PQnfields(result)));
  for (int row = 0; row < PQntuples(result); ++row) {
    for (int column = 0; column < PQnfields(result); ++column) {
      const bool is_null = PQgetisnull(result, row, column) == 1;
      fields_.push_back({reinterpret_cast<const std::byte*>(PQgetvalue(result, row, column)),
                         is_null ? Field::kNull : PQgetlength(result, row, column)});
    }
  }
}

Row Result::operator[](std::size_t row) const {
  if (row >= rows_)
    throw Error(ErrorKind::kInternal, origin_->path, origin_->place, detail::Concat("row ", row, " of ", rows_));
  const std::size_t columns = fields_.size() / rows_;
  return {std::span(fields_).subspan(row * columns, columns), *origin_};
}

std::int64_t Result::changed() const { return ChangedRows(handle_.get()); }

void Connection::Finish::operator()(pg_conn* connection) const { PQfinish(connection); }

Connection::Connection(const std::string& uri, const ConnectionOptions& options) : path_(detail::WithoutPassword(uri)) {
  if (!detail::IsServer(uri)) throw Error(ErrorKind::kUsage, path_, "", "is no server: postgresql://host/database is");
  handle_.reset(Connect(detail::WithHiddenPassword(uri), path_, options));
}

bool Connection::is_lost() const { return PQstatus(handle_.get()) == CONNECTION_BAD; }

ServerError Connection::Failure(const pg_result* result, const std::string& place) const {
  const std::string_view state = FieldOf(result, PG_DIAG_SQLSTATE);
  if (!state.empty()) return ErrorOfState(path_, place, state, MessageOf(result));
  const char* message = PQerrorMessage(handle_.get());
  return is_lost() ? ConnectionLost(path_, place, message) : ErrorOfState(path_, place, "", message);
}

void Connection::Execute(const std::string& sql) {
  const ResultHandle result(PQexec(handle_.get(), sql.c_str()));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_EMPTY_QUERY) return;
  throw Failure(result.get(), "");
}

Result Connection::Query(const std::string& sql, const std::vector<Parameter>& parameters, std::string place) {
  std::vector<Oid> types;
  std::vector<const char*> values;
  std::vector<int> lengths;
  for (const Parameter& parameter : parameters) {
    if (parameter.bytes().size() > kLargest)
      throw Error(ErrorKind::kNotPossible, path_, place, "a value larger than PostgreSQL holds (1 GB)");
    types.push_back(parameter.type());
    values.push_back(parameter.is_null() ? nullptr : parameter.bytes().c_str());
    lengths.push_back(static_cast<int>(parameter.bytes().size()));
  }
  const std::vector<int> formats(parameters.size(), kBinary);
  ResultHandle result(PQexecParams(handle_.get(), sql.c_str(), static_cast<int>(parameters.size()), types.data(),
                                   values.data(), lengths.data(), formats.data(), kBinary));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) throw Failure(result.get(), place);
  return {result.release(), {path_, std::move(place)}};
}

std::int64_t Connection::Integer(const std::string& sql, const std::vector<Parameter>& parameters) {
  const Result result = Query(sql, parameters);
  return result.rows() == 0 ? 0 : result[0].Integer(0);
}

// The search path is set in the transaction, so that a pool of connections that gives each transaction another one
// will do. That it may write is not said: only what a standby is really asked to write is an error. Tables of a
// partition on another server are joined there. Statements that copy rows are neither compiled nor given to more
// processes, whose start takes longer.
Transaction::Transaction(Connection& connection, Kind kind) : connection_(connection) {
  const std::string level = kind == Kind::kRead ? "REPEATABLE READ READ ONLY" : "READ COMMITTED";
  connection.Execute("BEGIN ISOLATION LEVEL " + level +
                     "; SET LOCAL search_path TO slamdb, pg_temp; SET LOCAL enable_partitionwise_join TO on; "
                     "SET LOCAL jit TO off; SET LOCAL max_parallel_workers_per_gather TO 0" +
                     (kind == Kind::kWriteWithoutSync ? "; SET LOCAL synchronous_commit TO off" : ""));
}

Transaction::~Transaction() {
  if (open_) const ResultHandle ignored(PQexec(connection_.handle(), "ROLLBACK"));
}

// Of a transaction in which a statement failed, COMMIT is a ROLLBACK, and no error.
void Transaction::Commit() {
  open_ = false;
  const ResultHandle result(PQexec(connection_.handle(), "COMMIT"));
  if (PQresultStatus(result.get()) != PGRES_COMMAND_OK) throw connection_.Failure(result.get(), "");
  if (std::string_view(PQcmdStatus(result.get())) != "COMMIT")
    throw Error(ErrorKind::kInternal, connection_.path(), "", "a statement had failed before: nothing was saved");
}

}  // namespace slamdb::postgresql
