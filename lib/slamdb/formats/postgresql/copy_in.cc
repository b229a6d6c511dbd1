// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/copy_in.h"

#include <libpq-fe.h>

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/handles.h"

namespace slamdb::postgresql {
namespace {

std::string TableOf(const std::string& target) { return target.substr(0, target.find(' ')); }

// `(a, b)` of `table (a, b)`.
std::string ColumnsOf(const std::string& target) { return target.substr(target.find('(')); }

// `a, b` of the same.
std::string WithoutParentheses(const std::string& columns) { return columns.substr(1, columns.size() - 2); }

}  // namespace

CopyIn::CopyIn(Connection& connection, const std::string& target, std::vector<Type> types, Way way)
    : connection_(connection),
      target_(target),
      place_("table " + TableOf(target)),
      is_staged_(way == Way::kInBatches || connection.has_row_security()),
      encoder_({connection.path(), place_}, std::move(types)) {
  const std::string columns = ColumnsOf(target);
  if (is_staged_)
    connection.Execute("CREATE TEMPORARY TABLE staged ON COMMIT DROP AS SELECT " + WithoutParentheses(columns) +
                       " FROM " + TableOf(target) + " WITH NO DATA");
  const std::string sql = "COPY " + (is_staged_ ? "staged " + columns : target) + " FROM STDIN (FORMAT binary)";
  const ResultHandle result(PQexec(connection.handle(), sql.c_str()));
  if (PQresultStatus(result.get()) != PGRES_COPY_IN) throw connection.Failure(result.get(), place_);
  is_open_ = true;
}

CopyIn::~CopyIn() {
  if (!is_open_) return;
  PQputCopyEnd(connection_.handle(), "not finished");
  Drain(connection_.handle());
}

// A server that refuses a row says so only when the copy is ended.
void CopyIn::ThrowFailure() {
  is_open_ = false;
  PQputCopyEnd(connection_.handle(), "cannot be sent");
  const ResultHandle result(PQgetResult(connection_.handle()));
  const ServerError error = connection_.Failure(result.get(), place_);
  Drain(connection_.handle());
  throw error;
}

void CopyIn::Send() {
  constexpr std::size_t kMessage = std::size_t{8} << 20;  // rows may be as large as servers take no message to be
  std::string& bytes = encoder_.bytes();
  for (std::size_t at = 0; at < bytes.size(); at += kMessage) {
    const std::size_t size = std::min(kMessage, bytes.size() - at);
    if (PQputCopyData(connection_.handle(), &bytes[at], static_cast<int>(size)) != 1) ThrowFailure();
  }
  bytes.clear();
}

std::int64_t CopyIn::Finish() {
  encoder_.AppendTrailer();
  Send();
  is_open_ = false;
  const bool is_sent = PQputCopyEnd(connection_.handle(), nullptr) == 1;
  const ResultHandle result(PQgetResult(connection_.handle()));
  if (!is_sent || PQresultStatus(result.get()) != PGRES_COMMAND_OK) {
    const ServerError error = connection_.Failure(result.get(), place_);
    Drain(connection_.handle());
    throw error;
  }
  Drain(connection_.handle());
  std::int64_t taken = ChangedRows(result.get());
  if (is_staged_) {
    const std::string columns = WithoutParentheses(ColumnsOf(target_));
    taken = connection_.Query("INSERT INTO " + target_ + " SELECT " + columns + " FROM staged", {}, place_).changed();
    connection_.Execute("DROP TABLE staged");
  }
  if (taken != encoder_.rows())
    throw Error(ErrorKind::kNotPossible, connection_.path(), place_,
                detail::Concat("took ", taken, " of ", encoder_.rows(),
                               " rows: a trigger, a rule or a policy of the database keeps the others out"));
  return taken;
}

}  // namespace slamdb::postgresql
