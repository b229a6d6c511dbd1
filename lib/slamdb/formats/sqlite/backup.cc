// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/backup.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
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

void RequireStore(Database& target) {
  const bool is_empty = target.Integer("SELECT count(*) FROM sqlite_schema") == 0;
  if (!is_empty && target.Integer("PRAGMA application_id") != kApplicationId)
    throw Error(ErrorKind::kUnsupported, target.path(), "",
                "is the database of another program, which no backup replaces; name another file");
}

// One transaction of SQLite on the target, which others see at its end or not at all. What somebody saves there
// meanwhile is not known to whoever wants it replaced: the copy is given up then.
void Restore(Database& source, const std::string& path) {
  Database watch(path, Access::kWrite, source.lock_timeout()), target(path, Access::kWrite, source.lock_timeout());
  RequireStore(watch);
  const std::string page_size = detail::Concat("PRAGMA page_size=", source.Integer("PRAGMA page_size"));
  target.Execute("PRAGMA synchronous=EXTRA; " + page_size);  // heeded by empty files
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

// Where a link leads that leads to nothing yet.
std::string FollowDangling(const std::string& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::filesystem::path at = path;
  std::error_code is_no_link;
  for (int links = 0; links < kMostLinks; ++links) {
    const auto next = std::filesystem::read_symlink(at, is_no_link);
    if (is_no_link) break;
    at = at.parent_path() / next;
  }
  return at.string();
}

// A file under a name of its own, removed unless it was given its right one.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& target) : target_(target), path_(target + ".XXXXXX") {
    descriptor_ = ::mkostemp(path_.data(), O_CLOEXEC);
    if (descriptor_ < 0) throw SystemError(target, "cannot create a file beside it");
  }
  ~TemporaryFile() {
    ::close(descriptor_);
    if (!placed_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

  // Who may read the original may read this one, and nobody else.
  void TakeRightsOf(const std::string& original) {
    struct stat status {};
    if (::stat(original.c_str(), &status) != 0) throw SystemError(original, "cannot read its permissions");
    mode_t mode = status.st_mode & 07777;
    const bool same_group = ::fchown(descriptor_, static_cast<uid_t>(-1), status.st_gid) == 0;
    if (!same_group) mode &= ~static_cast<mode_t>(070) | (mode & 07) << 3;  // another group has the rights of others
    if (::geteuid() == 0 && ::fchown(descriptor_, status.st_uid, static_cast<gid_t>(-1)) != 0)
      throw SystemError(target_, "cannot be given to the owner of the original");
    if (::fchmod(descriptor_, mode) != 0) throw SystemError(target_, "cannot be given the permissions of the original");
  }

  // Throws Error (kAlreadyExists) when somebody else has taken the name.
  void Place() {
    if (::fsync(descriptor_) != 0) throw SystemError(target_, "cannot be synced to disk");
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) != 0) {
      if (errno == EEXIST) throw ExistsError(target_);
      throw SystemError(target_, "cannot rename the finished file into place");
    }
    placed_ = true;
    SyncFolder();
  }

  static Error ExistsError(const std::string& target) {
    return Error(ErrorKind::kAlreadyExists, target, "", "exists already; `overwrite` of Store::Backup replaces it");
  }

 private:
  void SyncFolder() const {
    const auto folder = std::filesystem::absolute(target_).parent_path();
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
    if (descriptor >= 0) ::close(descriptor);
    if (!synced) throw SystemError(target_, "is written, but its folder cannot be synced to disk");
  }

  std::string target_, path_;
  int descriptor_ = -1;
  bool placed_ = false;
};

void CopyToNew(Database& source, const std::string& path) {
  TemporaryFile temporary(path);
  {
    Database target(temporary.path(), Access::kWrite, source.lock_timeout());
    target.Execute("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF");
    Copying(source, target).Finish();
  }
  temporary.TakeRightsOf(source.path());
  temporary.Place();
}

}  // namespace

void BackupTo(Database& source, const std::string& target, bool overwrite) {
  if (target.empty()) throw Error(ErrorKind::kUsage, "a copy needs the name of a file, and this one is empty");
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  if (!std::filesystem::exists(status)) return CopyToNew(source, FollowDangling(target));
  if (std::filesystem::is_directory(status)) throw Error(ErrorKind::kUsage, target, "", "is a directory");
  if (!overwrite) throw TemporaryFile::ExistsError(target);
  if (std::filesystem::equivalent(source.path(), target, ignored))
    throw Error(ErrorKind::kUsage, target, "", "is the store itself");
  Restore(source, target);
}

}  // namespace slamdb::sqlite
