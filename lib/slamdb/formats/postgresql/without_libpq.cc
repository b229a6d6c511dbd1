// SPDX-License-Identifier: BSD-3-Clause
// In place of what needs libpq, where it is not there: nobody gets a Connection, so nothing else is ever called.
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/postgresql/detail/connect.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/copy_in.h"

namespace slamdb::postgresql {
namespace {

[[noreturn]] void Refuse(const std::string& path) {
  throw Error(ErrorKind::kUnsupported, path, "",
              "this slamdb was built without PostgreSQL: install libpq-dev and build it again");
}

}  // namespace

void Result::Clear::operator()(pg_result*) const {}
Result::Result(pg_result*, RowOrigin) { Refuse(""); }
Row Result::operator[](std::size_t) const { Refuse(""); }
std::int64_t Result::changed() const { return 0; }

void Connection::Finish::operator()(pg_conn*) const {}
Connection::Connection(const std::string& uri, const ConnectionOptions&) : path_(detail::WithoutPassword(uri)) {
  if (!detail::IsServer(uri)) throw Error(ErrorKind::kUsage, path_, "", "is no server: postgresql://host/database is");
  Refuse(path_);
}
bool Connection::is_lost() const { return true; }
ServerError Connection::Failure(const pg_result*, const std::string&) const { Refuse(path_); }
void Connection::Execute(const std::string&) { Refuse(path_); }
Result Connection::Query(const std::string&, const std::vector<Parameter>&, std::string) { Refuse(path_); }
std::int64_t Connection::Integer(const std::string&, const std::vector<Parameter>&) { Refuse(path_); }

std::map<std::string, std::string> ParametersOf(const Connection& connection, const std::string&) {
  Refuse(connection.path());
}

struct CopyReader::State {};
CopyReader::CopyReader(Connection& connection, const std::string&, std::string) { Refuse(connection.path()); }
CopyReader::~CopyReader() = default;
bool CopyReader::Next() { return false; }
Row CopyReader::row() const { Refuse(""); }
std::shared_ptr<const char> CopyReader::message() const { Refuse(""); }

Transaction::Transaction(Connection& connection, Kind) : connection_(connection) { Refuse(connection.path()); }
Transaction::~Transaction() = default;
void Transaction::Commit() {
  open_ = false;
  Refuse(connection_.path());
}

CopyIn::CopyIn(Connection& connection, const std::string& target, std::vector<Type> types, Way)
    : connection_(connection),
      target_(target),
      place_(target),
      encoder_({connection.path(), target}, std::move(types)) {
  Refuse(connection.path());
}
CopyIn::~CopyIn() = default;
void CopyIn::Send() { Refuse(place_); }
std::int64_t CopyIn::Finish() { Refuse(place_); }

}  // namespace slamdb::postgresql
