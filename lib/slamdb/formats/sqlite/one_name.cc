// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/one_name.h"

#include <fcntl.h>
#include <linux/stat.h>
#include <sys/stat.h>

#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"

namespace slamdb::sqlite {
namespace {

// False where the system does not know.
bool IsMountPoint(const std::string& path) {
#ifdef STATX_ATTR_MOUNT_ROOT
  struct statx status {};
  return ::statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS, &status) == 0 &&
         (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
#else
  static_cast<void>(path);
  return false;
#endif
}

}  // namespace

void CheckHasOneName(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  if (status.st_nlink > 1)
    throw Error(ErrorKind::kUsage, path, "",
                detail::Concat("the file has ", status.st_nlink,
                               " names (hard links), and SQLite keeps a log beside "
                               "each, so that what is saved under one is lost under another: remove the other names, "
                               "or write to a copy; a symbolic link does no harm"));
  if (IsMountPoint(path))
    throw Error(ErrorKind::kUsage, path, "",
                "the file is mounted by itself, so that its log would stay on this side of the mount and be lost "
                "for everybody else: mount its folder");
}

void CheckLogIsOfThisName(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || status.st_nlink < 2 || HasContent(FilesBeside(path).log)) return;
  std::error_code failed;
  const auto folder = detail::FolderOf(detail::FollowLinks(path));
  for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    struct stat other {};
    const std::string name = entry->path().string();
    const bool is_same_file = ::lstat(name.c_str(), &other) == 0 && S_ISREG(other.st_mode) &&
                              other.st_ino == status.st_ino && other.st_dev == status.st_dev;
    if (is_same_file && HasContent(FilesBeside(name).log))
      throw Error(ErrorKind::kUsage, path, "",
                  detail::Concat("the file has another name, ", name,
                                 ", and what was saved last lies in the log beside that one: read it by that name"));
  }
}

}  // namespace slamdb::sqlite
