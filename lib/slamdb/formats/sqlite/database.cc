// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/database.h"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <thread>

#include "slamdb/base/detail/errno_kind.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/formats/sqlite/detail/batch_insert.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/image.h"
#include "slamdb/formats/sqlite/detail/one_name.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"

namespace slamdb::sqlite {
namespace {

// What SQLite's error codes mean to a caller. `system_error` is the errno behind the code, 0 when there is none.
ErrorKind KindOf(int code, int system_error) {
  if (code == SQLITE_READONLY_DBMOVED) return ErrorKind::kLocked;
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
    case SQLITE_CONSTRAINT:  // a migration refuses, or rows contradict each other
      return code == SQLITE_CONSTRAINT_CHECK ? ErrorKind::kNotPossible : ErrorKind::kDamaged;
    case SQLITE_MISUSE:
    case SQLITE_RANGE:
      return ErrorKind::kInternal;
    default:
      return ErrorKind::kDamaged;
  }
}

// What SQLite says in front of the name of a constraint, which in a migration is a sentence.
constexpr std::string_view kCheckFailed = "CHECK constraint failed: ";

// What a connection says that may not write to its file.
std::string ExplainReadOnly(int code, const std::string& message) {
  switch (code) {
    case SQLITE_READONLY_DBMOVED:
      return "was removed, moved or replaced by another program since it was opened: nothing was saved; try again";
    case SQLITE_READONLY_DIRECTORY:
      return "its folder cannot be written, in which a journal has to be laid beside it";
    case SQLITE_READONLY_ROLLBACK:
    case SQLITE_READONLY_RECOVERY:
    case SQLITE_READONLY_CANTINIT:
    case SQLITE_READONLY_CANTLOCK:
      return "the log or the journal beside it has to be worked through, and one of the files cannot be written";
    default:
      return "is open for reading, or its permissions do not let it be written (" + message + ")";
  }
}

std::string Explain(int code, int system_error, const std::string& message) {
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      return "not a SQLite database";
    case SQLITE_CORRUPT:
      return "the database file is damaged (" + message + "): restore a backup, or try `sqlite3 FILE .recover`";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "locked by another program";
    case SQLITE_FULL:
      return "the disk is full; the store is as it was before this change";
    case SQLITE_CANTOPEN:
      return "the file, or those that SQLite lays beside it, cannot be opened: " +
             (system_error == 0 ? "may its folder be written?" : std::generic_category().message(system_error));
    case SQLITE_READONLY:
      return ExplainReadOnly(code, message);
    case SQLITE_IOERR:
      return "input or output failed (" +
             (system_error == 0 ? message : std::generic_category().message(system_error)) + ")";
    case SQLITE_NOMEM:
      return "out of memory";
    case SQLITE_TOOBIG:
      return "an entity is larger than SQLite can hold (1 GB)";
    case SQLITE_CONSTRAINT:
      return message.starts_with(kCheckFailed) ? message.substr(kCheckFailed.size()) : message;
    default:
      return message;
  }
}

// SQLite takes the number of a page beyond all bounds, as damage makes it, for a disk that is full. A disk that has
// room tells that it may be so, and then a look at the pages whether it is.
bool IsDamagedNotFull(sqlite3* handle, const std::string& path) {
  constexpr std::uintmax_t kRoom = std::uintmax_t{64} << 20;
  std::error_code failed;
  const auto space = std::filesystem::space(std::filesystem::absolute(path, failed).parent_path(), failed);
  if (failed || space.available < kRoom) return false;
  bool sound = false;
  const auto note = [](void* is_sound, int, char** columns, char**) {
    *static_cast<bool*>(is_sound) = columns[0] != nullptr && std::string_view(columns[0]) == "ok";
    return 0;
  };
  sqlite3_exec(handle, "PRAGMA quick_check(1)", note, &sound, nullptr);
  return !sound;
}

void CheckIsFile(const std::string& path, bool may_be_missing) {
  if (path.empty()) throw Error(ErrorKind::kUsage, "a store needs the name of a file, and this one is empty");
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) throw Error(ErrorKind::kUsage, path, "", "is a directory, not a store");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error(ErrorKind::kUsage, path, "", "is a device or pipe; a store is a regular file");
  if (!may_be_missing && !std::filesystem::exists(status)) throw Error(ErrorKind::kNotFound, path, "", "no such file");
}

// Under which SQLite takes any path for that of a file.
std::string FileNameOf(const std::string& path) { return path.starts_with('/') ? path : "./" + path; }

bool Exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

// Whether a log lies there without its index, as a copy or a program that was killed leaves it. Looked at twice, since
// who closes a store removes the index first, and then the log.
bool LacksIndex(const FilesBeside& beside) {
  const auto lacks = [&] { return HasContent(beside.log) && !Exists(beside.index); };
  if (!lacks()) return false;
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return lacks();
}

// What no store of ours needs, and what a hostile one could use to take time or memory.
void LimitWhatFilesCanDo(sqlite3* handle) {
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0, nullptr);
  constexpr std::pair<int, int> kLimits[] = {
      {SQLITE_LIMIT_SQL_LENGTH, 1'000'000},
      {SQLITE_LIMIT_COLUMN, 200},
      {SQLITE_LIMIT_EXPR_DEPTH, 100},
      {SQLITE_LIMIT_COMPOUND_SELECT, 20},
      {SQLITE_LIMIT_VDBE_OP, 100'000},
      {SQLITE_LIMIT_FUNCTION_ARG, 32},
      {SQLITE_LIMIT_ATTACHED, 1},  // VACUUM attaches what it builds
      {SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 100},
      {SQLITE_LIMIT_TRIGGER_DEPTH, 1},
      {SQLITE_LIMIT_WORKER_THREADS, 0},
  };
  for (const auto& [limit, value] : kLimits) sqlite3_limit(handle, limit, value);
}

// What a file is that SQLite does not take for its own; nullopt when nothing is known, or that it was a store.
std::optional<detail::Recognized> RecognizeOther(const std::string& path) {
  if (std::error_code failed; !std::filesystem::is_regular_file(path, failed)) return std::nullopt;  // it is in memory
  auto recognized = detail::Recognize(Probe::Of(path));
  if (recognized && recognized->id == "store") recognized.reset();
  if (recognized && recognized->id == "archive") recognized->next = "save it into a store first";
  return recognized;
}

}  // namespace

Error FailureOf(sqlite3* handle, int code, const std::string& path, const std::string& place, std::string_view what) {
  if ((code & 0xff) == SQLITE_NOTADB)
    if (const auto other = RecognizeOther(path))
      return Error(other->kind, path, "", detail::SentenceOf(*other, "a store"));
  const int system_error = handle == nullptr ? 0 : sqlite3_system_errno(handle);
  const std::string message = sqlite3_errmsg(handle);
  if ((code & 0xff) == SQLITE_FULL && handle != nullptr && IsDamagedNotFull(handle, path))
    return Error(ErrorKind::kDamaged, path, place,
                 std::string(what) + Explain(SQLITE_CORRUPT, 0, sqlite3_errstr(SQLITE_CORRUPT)));
  return Error(KindOf(code, system_error), path, place, std::string(what) + Explain(code, system_error, message));
}

bool Waiting::Pause(int attempt) {
  using Clock = std::chrono::steady_clock;
  constexpr double kShortest = 0.001, kLongest = 0.05;
  if (attempt == 0) start_ = Clock::now();
  const double waited = std::chrono::duration<double>(Clock::now() - start_).count();
  if (!(waited < timeout_)) return false;
  try {
    if (progress_) progress_("waiting for another program that writes", waited / timeout_);
  } catch (...) {
    thrown_ = std::current_exception();  // SQLite, which called, knows no exceptions
    return false;
  }
  const double pause = std::min({kShortest * (attempt + 1), kLongest, timeout_ - waited});
  std::this_thread::sleep_for(std::chrono::duration<double>(pause));
  return true;
}

void Waiting::Rethrow() {
  if (thrown_ != nullptr) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

Database::Database(const std::string& path, Access access, double lock_timeout, Progress progress)
    : path_(path), waiting_(std::make_unique<Waiting>(lock_timeout, std::move(progress))) {
  CheckIsFile(path, access == Access::kCreate);
  const bool writes = access == Access::kWrite || access == Access::kCreate;
  writes ? CheckHasOneName(path) : CheckLogIsOfThisName(path);
  if (access == Access::kSalvage || access == Access::kImage)
    OpenImage(access);
  else if (access == Access::kRead)
    OpenToRead();
  else
    OpenToWrite(access);
}

Database Database::InMemory(const std::string& called) {
  Database database(called);
  database.OpenMemory();
  database.UseHugePages();
  database.Execute("PRAGMA cache_size=-512");  // pages go where there is memory for them; so they do while it is warm
  sqlite3_int64 most = std::int64_t{1} << 40;
  sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_SIZE_LIMIT, &most);
  return database;
}

// What is written page by page takes few page faults then. Larger databases grow out of these addresses.
void Database::UseHugePages() {
  constexpr std::size_t kAddresses = std::size_t{64} << 20, kHugePage = std::size_t{2} << 20;
  void* buffer = sqlite3_malloc64(kAddresses);
  if (buffer == nullptr) return;
#ifdef MADV_HUGEPAGE
  const auto begin = (reinterpret_cast<std::uintptr_t>(buffer) + kHugePage - 1) & ~(kHugePage - 1);
  ::madvise(reinterpret_cast<void*>(begin), kAddresses - kHugePage, MADV_HUGEPAGE);
#endif
  constexpr unsigned kFlags = SQLITE_DESERIALIZE_RESIZEABLE | SQLITE_DESERIALIZE_FREEONCLOSE;
  const int code = sqlite3_deserialize(handle(), "main", static_cast<unsigned char*>(buffer), 0, kAddresses, kFlags);
  if (code != SQLITE_OK) throw Failure("", code);
}

Database Database::Temporary(const std::string& called) {
  Database database(called);
  database.OpenHandle("", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);  // so does SQLite call such a file
  database.Execute(
      "PRAGMA temp_store=FILE; PRAGMA cache_size=-16384; PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; "
      "PRAGMA foreign_keys=OFF; PRAGMA ignore_check_constraints=ON");
  return database;
}

Database Database::OfBytes(Bytes bytes, const std::string& called) {
  Database database(called);
  database.OpenMemory();
  auto* data = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data()));  // read only, as the flag says
  constexpr std::size_t kFormats = 18;  // two bytes of the header: 2 where there is, or was, a log beside the file
  if (bytes.size() > kFormats + 2 && (bytes[kFormats] == std::byte{2} || bytes[kFormats + 1] == std::byte{2})) {
    database.copy_.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    database.copy_[kFormats] = database.copy_[kFormats + 1] = 1;
    data = reinterpret_cast<unsigned char*>(database.copy_.data());
  }
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  const int code = sqlite3_deserialize(database.handle(), "main", data, size, size, SQLITE_DESERIALIZE_READONLY);
  if (code != SQLITE_OK) throw database.Failure("", code);
  if (const int begun = database.BeginReading(); begun != SQLITE_OK) throw database.Failure("", begun);
  return database;
}

void Database::OpenMemory() {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(
      "slamdb", &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
      "memdb");
  handle_.reset(handle);
  if (code != SQLITE_OK) throw FailureOf(handle, code, path_, "", "cannot open: ");
  LimitWhatFilesCanDo(handle);
}

Bytes Database::Serialized() {
  sqlite3_int64 size = 0;
  auto* bytes = sqlite3_serialize(handle(), "main", &size, SQLITE_SERIALIZE_NOCOPY);
  if (bytes == nullptr || size < 100)
    throw Error(ErrorKind::kInternal, path_, "", "SQLite does not give what was written to memory");
  constexpr std::uint32_t kVersion = 3040001;  // the header tells which version of SQLite wrote it
  for (int i = 0; i < 4; ++i) bytes[96 + i] = static_cast<unsigned char>(kVersion >> (8 * (3 - i)));
  return {reinterpret_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)};
}

void Database::OpenHandle(const std::string& file, int flags, const char* vfs) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, vfs);
  handle_.reset(handle);
  if (code != SQLITE_OK) throw FailureOf(handle, code, path_, "", "cannot open: ");
  LimitWhatFilesCanDo(handle);
  RegisterVisit(handle);
  sqlite3_busy_handler(
      handle, [](void* waiting, int attempt) { return static_cast<Waiting*>(waiting)->Pause(attempt) ? 1 : 0; },
      waiting_.get());
}

int Database::BeginReading() {
  return sqlite3_exec(handle(), "PRAGMA query_only=ON; PRAGMA cache_size=-1024; SELECT 1 FROM sqlite_schema LIMIT 1",
                      nullptr, nullptr, nullptr);
}

// Opens for reading and writing where permitted, because only such a connection removes the (empty) log and index files
// that SQLite lays beside a store while it is open; query_only keeps it from writing. A log that a killed writer left
// is read and left alone; where its index is not there, it is read as an image, since SQLite would leave a new one. So
// is a store that cannot be written, or beside which nothing can be laid, unless a writer has laid those files already,
// whose locks then count.
void Database::OpenToRead() {
  const FilesBeside beside(path_);
  if (LacksIndex(beside)) return OpenImage(Access::kRead);
  OpenHandle(FileNameOf(path_), SQLITE_OPEN_READWRITE);
  if (HasContent(beside.log)) sqlite3_db_config(handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  const bool files_lie_beside = Exists(beside.log) && Exists(beside.index);
  const bool journal_lies_beside = HasContent(beside.journal);
  const bool writable = sqlite3_db_readonly(handle(), "main") == 0;
  if (!writable && !files_lie_beside && !journal_lies_beside) return OpenImage(Access::kRead);
  const int code = BeginReading();
  const bool lacks_rights = (code & 0xff) == SQLITE_CANTOPEN || (code & 0xff) == SQLITE_READONLY;
  if (lacks_rights && !journal_lies_beside) return OpenImage(Access::kRead);
  if (lacks_rights)
    throw Error(ErrorKind::kPermission, path_, "",
                "a journal of unfinished work (" + beside.journal +
                    ") lies beside it, and one of them cannot be written: copy both to another folder");
  if (code != SQLITE_OK) throw Failure("", code);
}

void Database::OpenImage(Access access) {
  const bool salvage = access == Access::kSalvage;
  OpenHandle(FileNameOf(path_), SQLITE_OPEN_READONLY, ImageVfs(salvage ? Missing::kIsZeros : Missing::kIsDamage));
  is_image_ = true;
  sqlite3_exec(handle(), "PRAGMA temp_store=MEMORY", nullptr, nullptr, nullptr);
  if (salvage) TolerateDamagedSchema();
  const int code = BeginReading();
  if (code != SQLITE_OK) throw Failure("", code);
}

// SQLite reads no table of a database of whose schema a page is lost, unless the schema may be written: then the first
// statement fails, and those after it see what was read until then. Tables come first in it, and views last.
void Database::TolerateDamagedSchema() {
  sqlite3_db_config(handle(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  sqlite3_exec(handle(), "PRAGMA query_only=ON; PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
  sqlite3_exec(handle(), "SELECT 1 FROM sqlite_schema", nullptr, nullptr, nullptr);
}

void Database::OpenToWrite(Access access) {
  OpenHandle(FileNameOf(path_), SQLITE_OPEN_READWRITE | (access == Access::kCreate ? SQLITE_OPEN_CREATE : 0));
  if (sqlite3_db_readonly(handle(), "main") == 1)
    throw Error(ErrorKind::kPermission, path_, "", "the file cannot be written");
  RegisterRows(handle());
}

void Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw Failure("", code);
}

void Database::UseLog() {
  for (int attempt = 0;; ++attempt) {
    const int code = sqlite3_exec(handle(), "PRAGMA journal_mode=WAL", nullptr, nullptr, nullptr);
    if (code == SQLITE_OK) return;
    if ((code & 0xff) != SQLITE_BUSY || !waiting_->Pause(attempt)) throw Failure("", code);
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

Error Database::Failure(const std::string& place, int code) const {
  waiting_->Rethrow();
  if (is_image_ && (code & 0xff) == SQLITE_BUSY)
    return Error(ErrorKind::kLocked, path_, "", "is being changed while it is read: try again");
  return FailureOf(handle(), code, path_, place);
}

}  // namespace slamdb::sqlite
