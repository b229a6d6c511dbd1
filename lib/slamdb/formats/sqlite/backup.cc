// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/backup.h"

#include <sys/stat.h>

#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/rights.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/writer_lock.h"

namespace slamdb::sqlite {
namespace {

// One run of SQLite's online backup. Ends without a change of the target unless Finish() was reached.
class Copying {
 public:
  Copying(Database& source, Database& target)
      : target_(target), backup_(sqlite3_backup_init(target.handle(), "main", source.handle(), "main")) {
    if (backup_ == nullptr) throw target.Failure("");
  }
  ~Copying() {
    if (backup_ != nullptr) sqlite3_backup_finish(backup_);
  }
  Copying(const Copying&) = delete;
  Copying& operator=(const Copying&) = delete;

  // Locks the target against other writers.
  void Lock() { Check(sqlite3_backup_step(backup_, 0)); }
  void Finish() {
    Check(sqlite3_backup_step(backup_, -1));
    const int finished = sqlite3_backup_finish(std::exchange(backup_, nullptr));
    if (finished != SQLITE_OK) throw target_.Failure("", finished);
  }

 private:
  void Check(int code) {
    if ((code & 0xff) == SQLITE_BUSY || (code & 0xff) == SQLITE_LOCKED) throw LockedError(target_);
    if (code != SQLITE_OK && code != SQLITE_DONE) throw target_.Failure("", code);
  }
  Database& target_;
  sqlite3_backup* backup_;
};

// ---- into a store that is there

// Whether the target is a store, or empty; what is damaged cannot be replaced under its lock.
void RequireStore(Database& target, std::int64_t page_bytes) try {
  if (target.Integer("SELECT count(*) FROM sqlite_schema") == 0) return;
  if (target.Integer("PRAGMA application_id") != kApplicationId)
    throw Error(ErrorKind::kUnsupported, target.path(), "",
                "is the database of another program, which no backup replaces; name another file");
  const std::int64_t bytes_there = target.Integer("PRAGMA page_size");
  if (bytes_there != page_bytes)
    throw Error(ErrorKind::kNotPossible, target.path(), "",
                detail::Concat("has pages of ", bytes_there, " bytes, and the copy ", page_bytes,
                               ", which a store in use cannot change: move it away with its `-wal` first, and the "
                               "copy becomes a new file"));
} catch (const Error& error) {
  if (error.kind() != ErrorKind::kDamaged) throw;
  throw Error(ErrorKind::kDamaged, target.path(), "",
              "is no store, or a damaged one, which cannot be replaced under its lock: move it away with its `-wal` "
              "first, and the copy becomes a new file");
}

// One transaction of SQLite on the target, which others see at its end or not at all. What somebody saves there
// meanwhile is not known to whoever wants it replaced: the copy is given up then.
void Restore(Database& source, const std::string& path) {
  Database watch(path, Access::kWrite, source.lock_timeout()), target(path, Access::kWrite, source.lock_timeout());
  const std::int64_t page_bytes = source.Integer("PRAGMA page_size");
  RequireStore(watch, page_bytes);
  target.Execute(detail::Concat("PRAGMA synchronous=EXTRA; PRAGMA page_size=", page_bytes));  // heeded by empty files
  target.UseLog();
  const std::int64_t seen = watch.Integer("PRAGMA data_version");
  Copying copying(source, target);
  copying.Lock();
  CheckStillThere(watch);
  if (watch.Integer("PRAGMA data_version") != seen)
    throw Error(
        ErrorKind::kLocked, path, "",
        "another program saved to it just now, which the copy would have lost: nothing was replaced; try again");
  copying.Finish();
}

// ---- into a new file

Error ExistsError(const std::string& target) {
  return Error(ErrorKind::kAlreadyExists, target, "", "exists already; `overwrite` of Store::Backup replaces it");
}

// Who may read the original may read this one, and nobody else.
void TakeRightsOf(const std::string& original, int descriptor, const std::string& target) {
  struct stat status {};
  if (::stat(original.c_str(), &status) != 0) throw SystemError(original, "cannot read its permissions");
  if (!detail::TakeRights(status, descriptor))
    throw SystemError(target, "cannot be given the permissions of the original");
}

void CopyToNew(Database& source, const std::string& path) {
  const std::string place = detail::FollowLinks(path).string();
  detail::RemoveDeadTemporaryFiles(place);
  detail::TemporaryFile temporary(place, S_IRUSR | S_IWUSR, path);
  {
    Database target(temporary.path(), Access::kWrite, source.lock_timeout());
    // In memory, since a killed program would leave a file; it stays empty, as there is nothing to take back. OFF is
    // not heeded by a connection that is DEFENSIVE.
    target.Execute("PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF");
    Copying(source, target).Finish();
  }
  TakeRightsOf(source.path(), temporary.descriptor(), path);
  if (detail::CallsOfFiles().fsync(temporary.descriptor()) != 0) throw SystemError(path, "cannot be synced to disk");
  temporary.Claim(place);
  detail::SyncFolderOf(place, path);
}

}  // namespace

void BackupTo(Database& source, const std::string& target, bool overwrite) {
  if (target.empty()) throw Error(ErrorKind::kUsage, "a copy needs the name of a file, and this one is empty");
  if (target == "-") throw Error(ErrorKind::kUsage, target, "", "a store is a file; it cannot be standard output");
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  if (!std::filesystem::exists(status)) return CopyToNew(source, target);
  if (std::filesystem::is_directory(status)) throw Error(ErrorKind::kUsage, target, "", "is a directory");
  if (!std::filesystem::is_regular_file(status))
    throw Error(ErrorKind::kUsage, target, "", "is a device or pipe; a store is a regular file");
  if (!overwrite) throw ExistsError(target);
  if (std::filesystem::equivalent(source.path(), target, ignored))
    throw Error(ErrorKind::kUsage, target, "", "is the store itself");
  Restore(source, target);
}

}  // namespace slamdb::sqlite
