// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/links.h"

#include <system_error>

namespace slamdb::detail {

namespace fs = std::filesystem;

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

bool IsOpenFile(const fs::path& followed) {
  const fs::path folder = followed.parent_path();
  return folder.filename() == "fd" && folder.native().starts_with("/proc/");
}

fs::path FollowLinks(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  fs::path at = path;
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code error;
    const fs::path folder = fs::canonical(FolderOf(at), error);
    if (error || at.filename().empty() || at.filename() == "..") return path;
    at = folder / at.filename();
    if (IsOpenFile(at) || !fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path next = fs::read_symlink(at, error);
    if (error) return path;
    at = folder / next;  // which is `next` alone when that is absolute
  }
  return path;
}

std::string LeadsTo(const std::string& path) {
  std::error_code missing;
  return fs::is_symlink(fs::symlink_status(path, missing)) ? FollowLinks(path).string() : path;
}

}  // namespace slamdb::detail
