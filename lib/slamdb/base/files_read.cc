// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/files_read.h"

#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

struct stat StatusOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) status = {};
  return status;
}

bool AreSame(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size &&
         a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

}  // namespace

void FilesRead::Note(const std::string& path) {
  const struct stat status = StatusOf(path);
  if (S_ISREG(status.st_mode) || status.st_mode == 0) noted_.emplace_back(path, status);
}

void FilesRead::RequireSame() const {
  for (const auto& [path, before] : noted_)
    if (!AreSame(before, StatusOf(path)))
      throw Error(ErrorKind::kLocked, path, "", "was replaced while it was read; read it again");
}

}  // namespace slamdb::detail
