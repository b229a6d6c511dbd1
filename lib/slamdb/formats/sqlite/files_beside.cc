// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/files_beside.h"

#include <filesystem>

namespace slamdb::sqlite {

FilesBeside::FilesBeside(const std::string& path) {
  std::error_code failed;
  const auto followed = std::filesystem::canonical(path, failed);
  const std::string file = failed ? path : followed.string();
  log = file + "-wal";
  index = file + "-shm";
  journal = file + "-journal";
}

bool HasContent(const std::string& path) {
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(path, missing);
  return !missing && bytes > 0;
}

}  // namespace slamdb::sqlite
