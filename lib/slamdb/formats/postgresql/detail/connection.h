// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/formats/postgresql/detail/errors.h"
#include "slamdb/formats/postgresql/detail/parameter.h"
#include "slamdb/formats/postgresql/detail/row.h"

struct pg_conn;
struct pg_result;

// PostgreSQL as this folder uses it: connections, results and copies that own their handles and throw slamdb::Error.
// Built without libpq, a Connection throws Error (kUnsupported) that says what to install.
namespace slamdb::postgresql {

struct ConnectionOptions {
  // Seconds to wait for each server while connecting, where neither the URI nor the environment says so
  // (connect_timeout, PGCONNECT_TIMEOUT).
  double timeout = 5;
  // Called while it connects, and ends that by throwing. May be empty.
  Progress progress;
};

// What a statement gives.
class Result {
 public:
  std::size_t rows() const { return rows_; }
  Row operator[](std::size_t row) const;  // valid as long as the result
  // The first column, of each row.
  std::vector<std::int64_t> Integers() const;
  std::vector<std::string> Texts() const;
  // How many rows an INSERT, UPDATE, DELETE or the like changed.
  std::int64_t changed() const;

 private:
  friend class Connection;
  Result(pg_result* result, RowOrigin origin);
  struct Clear {
    void operator()(pg_result* result) const;
  };

  std::unique_ptr<pg_result, Clear> handle_;
  std::unique_ptr<const RowOrigin> origin_;  // rows keep its address
  std::size_t rows_ = 0;
  std::vector<Field> fields_;
};

// One connection. Not thread-safe: one per thread.
//
// All else about connecting is libpq's own: TLS, .pgpass, service files, several hosts, target_session_attrs.
class Connection {
 public:
  // `uri` is one that IsServer() takes (base/detail/server.h).
  // Throws Error: a URI that libpq does not read, no server, no such database, not let in. Messages never hold a
  // password.
  explicit Connection(const std::string& uri, const ConnectionOptions& options = {});

  // The URI without its password, which errors call it.
  const std::string& path() const { return path_; }
  pg_conn* handle() const { return handle_.get(); }
  // True when the server is not to be heard any more: every call throws from now on.
  bool is_lost() const;

  // Whether row-level security counts for this user: set by who opens the store.
  bool has_row_security() const { return has_row_security_; }
  void set_has_row_security(bool has) { has_row_security_ = has; }

  // Statements without parameters and results, several with `;` between them.
  void Execute(const std::string& sql);
  // One statement. `place` is what it works on, for errors: `table map_point`.
  Result Query(const std::string& sql, const std::vector<Parameter>& parameters = {}, std::string place = {});
  // The first column of the first row; 0 when there is none.
  std::int64_t Integer(const std::string& sql, const std::vector<Parameter>& parameters = {});
  // Calls `visit(const Row&)` for each row of `sql`, `SELECT ...`, as they come: quicker than a Result, and of any
  // size. The row is valid during the call. What visit throws cancels the statement and comes through.
  template <class Visit>
  void CopyOut(const std::string& sql, Visit&& visit, std::string place = {});

  // The error of a result, or of the connection when that is null.
  ServerError Failure(const pg_result* result, const std::string& place) const;

 private:
  struct Finish {
    void operator()(pg_conn* connection) const;
  };
  std::string path_;
  std::unique_ptr<pg_conn, Finish> handle_;
  bool has_row_security_ = false;
};

inline std::vector<std::int64_t> Result::Integers() const {
  std::vector<std::int64_t> integers(rows());
  for (std::size_t i = 0; i < rows(); ++i) integers[i] = (*this)[i].Integer(0);
  return integers;
}

inline std::vector<std::string> Result::Texts() const {
  std::vector<std::string> texts(rows());
  for (std::size_t i = 0; i < rows(); ++i) texts[i] = (*this)[i].Text(0);
  return texts;
}

// What CopyOut is made of: rows one by one.
class CopyReader {
 public:
  CopyReader(Connection& connection, const std::string& sql, std::string place);
  // Cancels what is still to come, so that the connection can go on.
  ~CopyReader();
  CopyReader(const CopyReader&) = delete;
  CopyReader& operator=(const CopyReader&) = delete;

  // The next row, valid until the next call; false: there are no more.
  bool Next();
  Row row() const;
  // What the bytes of the row are in.
  std::shared_ptr<const char> message() const;

 private:
  struct State;
  bool TakeMessage();
  std::unique_ptr<State> state_;
};

template <class Visit>
void Connection::CopyOut(const std::string& sql, Visit&& visit, std::string place) {
  CopyReader reader(*this, sql, std::move(place));
  while (reader.Next()) visit(reader.row());
}

// A transaction in the schema `slamdb`. Rolls back unless Commit() was reached.
class Transaction {
 public:
  enum class Kind {
    kRead,              // reads see one state of the database, from the first of them on, and nothing can be written
    kWrite,             // reads see what others have committed meanwhile
    kWriteWithoutSync,  // the same, and a commit does not wait for the disk
  };
  Transaction(Connection& connection, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  // Throws also when the server takes back instead, because a statement had failed before.
  void Commit();

 private:
  Connection& connection_;
  bool open_ = true;
};

// A setting of the server while it lives, in a transaction.
//
// Most are of how the server goes about a statement. Of an atlas that is new its statistics know nothing: it takes it
// for a row or two, and joins by a loop in a loop, which is quadratic (enable_nestloop), or for a share of all, and
// reads whole tables (enable_seqscan). What is read and written of an atlas each time has no joins instead, as rows on
// other servers are joined as these choose.
class LocalSetting {
 public:
  LocalSetting(Connection& connection, const std::string& name, const std::string& value,
               const std::string& afterwards = "DEFAULT")
      : connection_(connection), back_("SET LOCAL " + name + " TO " + afterwards) {
    connection.Execute("SET LOCAL " + name + " TO " + value);
  }
  ~LocalSetting() {
    try {
      connection_.Execute(back_);
    } catch (const Error&) {  // the transaction has failed, and ends
    }
  }
  LocalSetting(const LocalSetting&) = delete;
  LocalSetting& operator=(const LocalSetting&) = delete;

 private:
  Connection& connection_;
  const std::string back_;
};

}  // namespace slamdb::postgresql
