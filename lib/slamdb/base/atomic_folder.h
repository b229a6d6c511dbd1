// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/file.h"
#include "slamdb/export.h"

namespace slamdb {

namespace detail {
class TemporaryFolder;
}

// A folder of files that appears whole or not at all: how every format is written that is more than one file.
// The files are made in a temporary folder beside it, of such a name as AtomicFile has. Commit() renames the folder
// where nothing or an empty folder is; into a folder that holds files, which needs `overwrite`, it moves one file after
// the other, in the order in which they were asked for, and leaves there what has other names. Without Commit() the
// temporary folder is removed and the target is as it was; what a killed program left is removed by the next one that
// writes into that folder. When one file cannot be moved, those before it are taken back; a program that is killed
// between two leaves new files beside old ones.
//
// Throws Error: kAlreadyExists when the target holds files and not `overwrite`, or an atlas or database in the place of
// one that is written; kUsage when it is no folder, is
// standard output or has no name, or when a file would be an input; and as the system has it (SystemError).
class SLAMDB_EXPORT AtomicFolder {
 public:
  explicit AtomicFolder(const Target& target, AtomicFileOptions options = {});
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  // A file in it that is written now, by a relative name: `sparse/0/cameras.bin`. Folders on the way are made.
  // Its owner commits it before this folder is committed.
  std::unique_ptr<AtomicFile> Make(const std::string& name);
  // All files are whole.
  void Commit();

 private:
  void MoveInto();

  std::string path_;    // as the user named it
  std::string target_;  // with symbolic links followed, without a slash at the end
  std::unique_ptr<detail::TemporaryFolder> temporary_;
  AtomicFileOptions options_;
  std::vector<std::string> names_;  // of the files made, in order
};

}  // namespace slamdb
