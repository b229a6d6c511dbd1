// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/writer_lock.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>

#include "slamdb/base/detail/concat.h"

namespace slamdb::sqlite {
namespace {

bool IsGone(std::int64_t process, const std::string& host) {
  return host == HostName() && ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH;
}

// Who the table says is writing; `another program` when it does not know.
std::string Holder(Database& database) {
  try {
    Statement statement(database, "SELECT process, host, tool, since FROM writer");
    if (!statement.Step() || IsGone(statement.Integer(0), statement.Text(1))) return "another program";
    return statement.Text(2) + ", process " + statement.Text(0) + " on host " + statement.Text(1) + ", since " +
           statement.Text(3);
  } catch (const Error&) {
    return "another program";  // which holds it so that it cannot even be read
  }
}

void Announce(Database& database) {
  Statement statement(database, "INSERT OR REPLACE INTO writer VALUES (1, ?1, ?2, ?3, ?4)", "table writer");
  const std::string host = HostName(), tool = ToolName(), since = TimeOfDay();
  statement.Bind(1, std::int64_t{::getpid()}).BindText(2, host).BindText(3, tool).BindText(4, since).Run();
}

}  // namespace

WriteTransaction::WriteTransaction(Database& database) : database_(database) {
  const auto begin = [&] {
    const int code = sqlite3_exec(database.handle(), "BEGIN IMMEDIATE", nullptr, nullptr, nullptr);
    if ((code & 0xff) == SQLITE_BUSY) throw LockedError(database);
    if (code != SQLITE_OK) throw database.Failure("", code);
  };
  begin();
  transaction_ = std::make_unique<Transaction>(database, Transaction::Kind::kJoin);
  CheckStillThere(database);
  if (!database.HasTable("writer")) return;
  Announce(database);
  transaction_->Commit();
  begin();
  transaction_ = std::make_unique<Transaction>(database, Transaction::Kind::kJoin);
}

void WriteTransaction::Commit() {
  CheckStillThere(database_);
  database_.Execute("DELETE FROM writer");
  transaction_->Commit();
}

Error LockedError(Database& database) {
  database.RethrowFromWaiting();
  return Error(ErrorKind::kLocked, database.path(), "",
               detail::Concat("locked by ", Holder(database), " (waited ", database.lock_timeout(),
                              " s): try again when it is done"));
}

bool StillThere(Database& database) {
  int moved = 0;
  sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  return moved == 0;
}

void CheckStillThere(Database& database) {
  if (StillThere(database)) return;
  throw Error(ErrorKind::kLocked, database.path(), "",
              "was removed, moved or replaced by another program since it was opened: nothing was saved; try again");
}

}  // namespace slamdb::sqlite
