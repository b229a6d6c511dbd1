// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/backup.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>

namespace slamdb::sqlite {
namespace {

// Removes the file when the copy does not come to its end.
struct TemporaryFile {
  std::string path;
  ~TemporaryFile() {
    if (!path.empty()) ::unlink(path.c_str());
  }
};

void Sync(const std::string& path, const std::string& reported) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!synced) throw SystemError(reported, "cannot sync");
}

void Copy(Database& source, const std::string& to, const std::string& target) {
  sqlite3* handle = nullptr;
  const int opened = sqlite3_open_v2(to.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close_v2)> closer(handle, &sqlite3_close_v2);
  if (opened != SQLITE_OK) throw FailureOf(handle, opened, target, "", "cannot create: ");
  sqlite3_exec(handle, "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF", nullptr, nullptr, nullptr);
  sqlite3_backup* backup = sqlite3_backup_init(handle, "main", source.handle(), "main");
  if (backup == nullptr) throw FailureOf(handle, sqlite3_extended_errcode(handle), target, "", "cannot write: ");
  const int stepped = sqlite3_backup_step(backup, -1);
  const int finished = sqlite3_backup_finish(backup);
  if (stepped != SQLITE_DONE || finished != SQLITE_OK)
    throw FailureOf(handle, finished != SQLITE_OK ? finished : stepped, target, "", "the copy failed: ");
}

}  // namespace

void BackupTo(Database& source, const std::string& target, bool overwrite) {
  std::error_code ignored;
  if (std::filesystem::is_directory(target, ignored)) throw Error(ErrorKind::kUsage, target, "", "is a directory");
  if (!overwrite && std::filesystem::exists(target, ignored))
    throw Error(ErrorKind::kAlreadyExists, target, "", "exists already; `overwrite` of Store::Backup replaces it");
  if (std::filesystem::equivalent(source.path(), target, ignored))
    throw Error(ErrorKind::kUsage, target, "", "is the store itself");
  TemporaryFile temporary{target + ".tmp-" + std::to_string(::getpid())};
  ::unlink(temporary.path.c_str());
  Copy(source, temporary.path, target);
  Sync(temporary.path, target);
  // A log beside the target would be taken for that of the new file.
  for (const char* suffix : {"-wal", "-shm", "-journal"}) ::unlink((target + suffix).c_str());
  if (::rename(temporary.path.c_str(), target.c_str()) != 0) throw SystemError(target, "cannot rename");
  temporary.path.clear();
  const auto folder = std::filesystem::absolute(target).parent_path();
  Sync(folder.string(), target);
}

}  // namespace slamdb::sqlite
