// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/stat.h>

#include <string>
#include <utility>
#include <vector>

#include "slamdb/export.h"

namespace slamdb::detail {

// Files that belong together, as they were before the first was read: a writer that began and ended in the meantime
// leaves no claim to see.
class SLAMDB_EXPORT FilesRead {
 public:
  // Before it is read. One that is missing is to stay missing; streams say nothing.
  void Note(const std::string& path);
  // Once all are read. Throws Error (kLocked) when one was replaced or written since.
  void RequireSame() const;

 private:
  std::vector<std::pair<std::string, struct stat>> noted_;
};

}  // namespace slamdb::detail
