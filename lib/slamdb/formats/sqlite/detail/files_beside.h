// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slamdb::sqlite {

// The files that SQLite keeps beside a database: beside the file that symbolic links lead to.
struct FilesBeside {
  explicit FilesBeside(const std::string& path);

  std::string log, index;  // the write-ahead log, and its index
  std::string journal;     // of a transaction
};

// Whether a file is there, and not empty.
bool HasContent(const std::string& path);

}  // namespace slamdb::sqlite
