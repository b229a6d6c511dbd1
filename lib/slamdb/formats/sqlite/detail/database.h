// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sqlite3.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/base/progress.h"
#include "slamdb/formats/rows/detail/value.h"

// SQLite as this folder uses it: connections and prepared statements that own their handles and throw slamdb::Error.
namespace slamdb::sqlite {

enum class Access {
  kRead,     // never changes the file; works on read-only disks and in read-only folders
  kImage,    // as kRead, without locks: the files of other programs, of which not even a journal is worked through
  kSalvage,  // as kImage, with what can be read of a damaged schema and of a file that was cut
  kWrite,    // the file is there
  kCreate,   // the file is made when it is missing
};

// What a failed call on a connection means: the code and the message of SQLite, explained and with a kind. `handle` may
// be null.
Error FailureOf(sqlite3* handle, int code, const std::string& path, const std::string& place,
                std::string_view what = {});

// Waits for other programs that use a store, at most `timeout` seconds; infinity is for ever.
class Waiting {
 public:
  // `progress` is called while it waits, and ends that by throwing. May be empty.
  explicit Waiting(double timeout, Progress progress = {}) : timeout_(timeout), progress_(std::move(progress)) {}

  // Called again and again while the store is locked, `attempt` from 0 on. False: the time is up, or progress threw.
  bool Pause(int attempt);
  // What progress threw, once.
  void Rethrow();
  double timeout() const { return timeout_; }

 private:
  double timeout_;
  Progress progress_;
  std::chrono::steady_clock::time_point start_{};
  std::exception_ptr thrown_;
};

// A row that differs from its hash.
struct EditedRow {
  std::string table;
  std::int64_t row = 0;
  std::uint64_t id = 0;  // of the entity that it is, or belongs to
};

// One connection. Not thread-safe: one per thread.
//
// A path is always that of a file: SQLite itself would take `:memory:`, `file:...` and an empty one for something else.
class Database {
 public:
  // Throws Error: no such file, a directory or another thing that is no file, not a database, no permission.
  Database(const std::string& path, Access access, double lock_timeout, Progress progress = {});

  // A database in memory: an empty one, to be filled, or of bytes, to be read, which are copied only where SQLite could
  // not read them as they are. `called` is what errors call it.
  static Database InMemory(const std::string& called);
  static Database OfBytes(Bytes bytes, const std::string& called);
  // An empty one that goes to a temporary file where it grows large, and is gone with the connection. Quick to fill:
  // what fails leaves nothing of use.
  static Database Temporary(const std::string& called);
  // The bytes of one that was filled. Valid until it is changed. Of the same content they are the same, whichever
  // version of SQLite made them.
  Bytes Serialized();

  const std::string& path() const { return path_; }
  sqlite3* handle() const { return handle_.get(); }

  void Execute(const std::string& sql);
  // Switches to a write-ahead log. Waits for others who do the same, which SQLite itself does not.
  void UseLog();
  double lock_timeout() const { return waiting_->timeout(); }
  void RethrowFromWaiting() { waiting_->Rethrow(); }  // what the listener to its progress threw, if it did
  std::int64_t Integer(const std::string& sql);       // the first column of the first row; 0 when there is none
  bool HasTable(std::string_view name);

  // True when the store is read as an Image, without locks: somebody who writes to it meanwhile shows as kLocked.
  bool is_image() const { return is_image_; }

  // From now on rows that differ from their hash are read as they are, and listed in `edits`, instead of being errors.
  void AcceptEdits(std::vector<EditedRow>* edits) { edits_ = edits; }
  std::vector<EditedRow>* edits() const { return edits_; }

  // The error of the last call on this connection, placed at `place` (`table map_point, row 12`).
  Error Failure(const std::string& place) const;
  Error Failure(const std::string& place, int code) const;

 private:
  Database() = default;
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };
  explicit Database(std::string called) : path_(std::move(called)), waiting_(std::make_unique<Waiting>(0)) {}
  void OpenHandle(const std::string& file, int flags, const char* vfs = nullptr);
  void OpenMemory();
  void UseHugePages();
  void OpenToRead();
  void OpenImage(Access access);
  int BeginReading();
  void TolerateDamagedSchema();
  void OpenToWrite(Access access);

  std::string path_;
  std::unique_ptr<Waiting> waiting_;  // SQLite keeps its address
  std::string copy_;                  // of bytes that SQLite reads
  std::unique_ptr<sqlite3, Close> handle_;
  bool is_image_ = false;
  std::vector<EditedRow>* edits_ = nullptr;
};

// A prepared statement, to be bound and stepped many times. Bound memory must live until the next Reset.
class Statement {
 public:
  // `place` says what the statement works on when it fails: `table map_point`.
  Statement(Database& database, std::string_view sql, std::string place = {});

  Statement& Bind(int index, std::int64_t value);
  Statement& Bind(int index, std::optional<std::int64_t> value);
  Statement& BindReal(int index, double value);  // NaN becomes NULL
  Statement& BindText(int index, std::string_view value);
  Statement& BindBlob(int index, Bytes value);
  Statement& BindNull(int index);
  Statement& BindAll(std::span<const rows::Value> values);           // from the first parameter on
  Statement& BindPointer(int index, void* value, const char* type);  // for a virtual table that knows the type

  bool Step();  // true: a row is there
  void Reset();
  void Run();                            // steps through and resets, for statements without result
  std::vector<std::int64_t> Integers();  // steps through and resets; the first column of each row

  int Columns() const { return sqlite3_column_count(handle_.get()); }
  int Type(int column) const { return sqlite3_column_type(handle_.get(), column); }  // SQLITE_INTEGER, ...
  bool IsNull(int column) const { return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL; }
  std::int64_t Integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
  double Real(int column) const;  // NaN for NULL
  std::string Text(int column) const;
  Bytes Blob(int column) const;  // valid until the next Step or Reset

 private:
  void Check(int code);

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Database* database_;
  std::string place_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

// BEGIN ... COMMIT. Rolls back unless Commit() was reached.
class Transaction {
 public:
  enum class Kind {
    kBegin,  // BEGIN: reads see one state of the store from the first of them on
    kJoin,   // the caller has begun one, and hands it over
  };
  Transaction(Database& database, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void Commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace slamdb::sqlite
