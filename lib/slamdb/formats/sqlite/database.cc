// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/database.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "slamdb/base/detail/errno_kind.h"

namespace slamdb::sqlite {
namespace {

// Wants a URI for `immutable=1`; everything but plain characters is escaped.
std::string ImmutableUri(const std::string& path) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char character : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(character);
    if (std::isalnum(byte) != 0 || character == '/' || character == '.' || character == '-' || character == '_') {
      uri += character;
    } else {
      uri += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return uri + "?immutable=1";
}

// What SQLite's error codes mean to a caller. `system_error` is the errno behind the code, 0 when there is none.
ErrorKind KindOf(int code, int system_error) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_PROTOCOL:
      return ErrorKind::kLocked;
    case SQLITE_FULL:
    case SQLITE_NOMEM:
      return ErrorKind::kOutOfResources;
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return ErrorKind::kPermission;
    case SQLITE_CANTOPEN:
    case SQLITE_IOERR:
      if (system_error != 0) return detail::KindOfErrno(system_error);
      return (code & 0xff) == SQLITE_CANTOPEN ? ErrorKind::kPermission : ErrorKind::kDamaged;
    case SQLITE_TOOBIG:
      return ErrorKind::kNotPossible;
    case SQLITE_CONSTRAINT:  // a trigger of a migration refuses, or rows contradict each other
      return code == SQLITE_CONSTRAINT_TRIGGER ? ErrorKind::kNotPossible : ErrorKind::kDamaged;
    case SQLITE_MISUSE:
    case SQLITE_RANGE:
      return ErrorKind::kInternal;
    default:
      return ErrorKind::kDamaged;
  }
}

std::string Explain(int code, const std::string& message) {
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      return "not a SQLite database";
    case SQLITE_CORRUPT:
      return "the database file is damaged (" + message + "): restore a backup, or try `sqlite3 FILE .recover`";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "locked by another program";
    case SQLITE_FULL:
      return "the disk is full; the store is as it was";
    case SQLITE_CANTOPEN:
      return "the file, or those that SQLite lays beside it, cannot be opened: may its folder be written?";
    case SQLITE_READONLY:
      return "the file or its folder cannot be written";
    case SQLITE_IOERR:
      return "input or output failed (" + message + ")";
    case SQLITE_NOMEM:
      return "out of memory";
    case SQLITE_TOOBIG:
      return "an entity is larger than SQLite can hold (1 GB)";
    default:
      return message;
  }
}

void CheckIsFile(const std::string& path, bool may_be_missing) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) throw Error(ErrorKind::kUsage, path, "", "is a directory, not a store");
  if (!may_be_missing && !std::filesystem::exists(status)) throw Error(ErrorKind::kNotFound, path, "", "no such file");
}

}  // namespace

Error FailureOf(sqlite3* handle, int code, const std::string& path, const std::string& place, std::string_view what) {
  const int system_error = handle == nullptr ? 0 : sqlite3_system_errno(handle);
  return Error(KindOf(code, system_error), path, place, std::string(what) + Explain(code, sqlite3_errmsg(handle)));
}

Database::Database(const std::string& path, Access access, double lock_timeout) : path_(path) {
  CheckIsFile(path, access == Access::kCreate);
  if (access == Access::kRead || access == Access::kSalvage) {
    OpenToRead(access, lock_timeout);
  } else {
    OpenToWrite(access, lock_timeout);
  }
}

void Database::OpenHandle(const std::string& name, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) throw FailureOf(handle, code, path_, "", "cannot open: ");
  // A hostile file must not reach functions or overwrite the schema through SQL of its own.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

// Opens for reading and writing where permitted, because only such a connection removes the (empty) log and index files
// that SQLite lays beside a store while it is open; query_only keeps it from writing. A log that a killed writer left
// is read and left alone. Where even those files cannot be made, and no log is there, nobody can be writing: immutable.
void Database::OpenToRead(Access access, double lock_timeout) {
  OpenHandle(path_, SQLITE_OPEN_READWRITE);
  if (access == Access::kSalvage) TolerateDamagedSchema();
  std::error_code missing;
  const auto log_bytes = std::filesystem::file_size(log_path(), missing);
  const bool has_log = !missing && log_bytes > 0;
  if (has_log) sqlite3_db_config(handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  sqlite3_busy_timeout(handle(), static_cast<int>(lock_timeout * 1000));
  const auto begin_reading = [this] {
    return sqlite3_exec(handle(), "PRAGMA query_only=ON; PRAGMA cache_size=-8192; SELECT 1 FROM sqlite_schema LIMIT 1",
                        nullptr, nullptr, nullptr);
  };
  int code = begin_reading();
  const int primary = code & 0xff;
  if ((primary == SQLITE_CANTOPEN || primary == SQLITE_READONLY) && !has_log) {
    OpenHandle(ImmutableUri(path_), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    immutable_ = true;
    if (access == Access::kSalvage) TolerateDamagedSchema();
    code = begin_reading();
  }
  if ((code & 0xff) == SQLITE_CANTOPEN && has_log) {
    throw Error(ErrorKind::kPermission, path_, "",
                "a log of unfinished work (" + log_path() +
                    ") lies beside it in a folder that cannot be written: copy both to another folder");
  }
  if (code != SQLITE_OK) throw Failure("", code);
}

// SQLite reads no table of a database of whose schema a page is lost, unless the schema may be written: then the first
// statement fails, and those after it see what was read until then. Tables come first in it, and views last.
void Database::TolerateDamagedSchema() {
  sqlite3_db_config(handle(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  sqlite3_exec(handle(), "PRAGMA query_only=ON; PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
  sqlite3_exec(handle(), "SELECT 1 FROM sqlite_schema", nullptr, nullptr, nullptr);
}

void Database::OpenToWrite(Access access, double lock_timeout) {
  OpenHandle(path_, SQLITE_OPEN_READWRITE | (access == Access::kCreate ? SQLITE_OPEN_CREATE : 0));
  sqlite3_busy_timeout(handle(), static_cast<int>(lock_timeout * 1000));
  if (sqlite3_db_readonly(handle(), "main") == 1)
    throw Error(ErrorKind::kPermission, path_, "", "the file cannot be written");
}

std::string Database::log_path() const { return std::string(sqlite3_db_filename(handle(), "main")) + "-wal"; }

void Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw Failure("", code);
}

void Database::UseLog(double lock_timeout) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kPause(5);
  const auto end = Clock::now() + std::chrono::duration<double>(lock_timeout);
  while (true) {
    const int code = sqlite3_exec(handle(), "PRAGMA journal_mode=WAL", nullptr, nullptr, nullptr);
    if (code == SQLITE_OK) return;
    if ((code & 0xff) != SQLITE_BUSY || Clock::now() >= end) throw Failure("", code);
    std::this_thread::sleep_for(kPause);
  }
}

std::int64_t Database::Integer(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.Step() ? statement.Integer(0) : 0;
}

bool Database::HasTable(std::string_view name) {
  Statement statement(*this, "SELECT 1 FROM sqlite_schema WHERE type IN ('table', 'view') AND name = ?1");
  return statement.BindText(1, name).Step();
}

Error Database::Failure(const std::string& place) const { return Failure(place, sqlite3_extended_errcode(handle())); }

Error Database::Failure(const std::string& place, int code) const { return FailureOf(handle(), code, path_, place); }

Statement::Statement(Database& database, std::string_view sql, std::string place)
    : database_(&database), place_(std::move(place)) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  handle_.reset(statement);
  if (code != SQLITE_OK) throw database.Failure(place_, code);
}

void Statement::Check(int code) {
  if (code != SQLITE_OK) throw database_->Failure(place_, code);
}

Statement& Statement::Bind(int index, std::int64_t value) {
  Check(sqlite3_bind_int64(handle_.get(), index, value));
  return *this;
}
Statement& Statement::Bind(int index, std::optional<std::int64_t> value) {
  return value ? Bind(index, *value) : BindNull(index);
}
Statement& Statement::BindReal(int index, double value) {
  Check(sqlite3_bind_double(handle_.get(), index, value));  // SQLite itself stores NaN as NULL
  return *this;
}
Statement& Statement::BindText(int index, std::string_view value) {
  const char* text = value.data() == nullptr ? "" : value.data();
  Check(sqlite3_bind_text64(handle_.get(), index, text, value.size(), SQLITE_STATIC, SQLITE_UTF8));
  return *this;
}
Statement& Statement::BindBlob(int index, Bytes value) {
  const void* bytes = value.empty() ? static_cast<const void*>("") : value.data();
  Check(sqlite3_bind_blob64(handle_.get(), index, bytes, value.size(), SQLITE_STATIC));
  return *this;
}
Statement& Statement::BindNull(int index) {
  Check(sqlite3_bind_null(handle_.get(), index));
  return *this;
}

bool Statement::Step() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) throw database_->Failure(place_, code);
  return false;
}

void Statement::Reset() { sqlite3_reset(handle_.get()); }

void Statement::Run() {
  while (Step()) {
  }
  Reset();
}

std::string Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column)));
}

Bytes Statement::Blob(int column) const {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(handle_.get(), column));
  if (bytes == nullptr) {
    if (sqlite3_errcode(database_->handle()) == SQLITE_NOMEM) throw database_->Failure(place_);
    return {};
  }
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

Transaction::Transaction(Database& database, Kind kind) : database_(database) {
  if (kind == Kind::kBegin) database.Execute("BEGIN");
}
Transaction::~Transaction() {
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}
void Transaction::Commit() {
  database_.Execute("COMMIT");
  open_ = false;
}

}  // namespace slamdb::sqlite
