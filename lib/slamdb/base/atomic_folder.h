// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/file.h"
#include "slamdb/export.h"

namespace slamdb {

namespace detail {
class FilesTogether;
}

// What a file may take the place of, where `overwrite` replaces those that are there.
enum class Replaces {
  kOthers,
  kEqual,  // one of the same bytes alone: another, as a picture, may be the only one there is
};

// A folder of files that appears whole or not at all: how every format is written that is a folder.
// The files are made in a temporary folder beside it, of such a name as AtomicFile has. Commit() renames the folder
// where nothing or an empty folder is, and exchanges it, in one step, with one that holds nothing but files of the same
// names. Into a folder that holds other files too, which stay, it moves one file after the other, in the order in which
// they were asked for. Both need `overwrite`. Without Commit() the temporary folder is removed and the target is as it
// was; what a killed program left is removed by the next one that writes into that folder.
//
// When one file cannot be moved, those before it are taken back. A program that is killed between two leaves new files
// beside old ones, and `.slamdb-unfinished`, which names them: reading such a folder is refused, and the next that
// writes the same files mends it. Of two that move files into one folder at once the second is refused.
//
// A sink takes the bytes of all files, one after the other, and nothing is written.
//
// Throws Error: kAlreadyExists when the target holds files and not `overwrite`, or, in the place of one that is
// written, an atlas, a database of other bytes, or what only an equal one replaces; kLocked when another program moves
// files into it; kUsage when it is no folder, is standard output or has no name, or when a file would be an input; and
// as the system has it (SystemError).
class SLAMDB_EXPORT AtomicFolder {
 public:
  explicit AtomicFolder(const Target& target, AtomicFileOptions options = {});
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  // A file in it that is written now, by a relative name: `sparse/0/cameras.bin`. Folders on the way are made.
  // Its owner commits it before this folder is committed.
  std::unique_ptr<AtomicFile> Make(const std::string& name, Replaces replaces = Replaces::kOthers);
  // All files are whole.
  void Commit();

 private:
  std::string path_;    // as the user named it
  std::string target_;  // with symbolic links followed, without a slash at the end
  AtomicFileOptions options_;
  Target::Sink sink_;                             // takes what the files hold, where there is one
  std::unique_ptr<detail::FilesTogether> files_;  // null with a sink
};

// Several files of one folder that belong together and lie among others, as osmap's four: written and replaced as those
// of AtomicFolder are, one after the other. `target`, a path, is the file by whose name they are known; where it is a
// symbolic link, they lie where that leads. Names are of the files alone, and with `overwrite` they are replaced. What
// names those that a killed program left is beside the first: `.STEM.slamdb-unfinished`. A sink takes the bytes of the
// target alone.
//
// Throws Error as AtomicFolder does.
class SLAMDB_EXPORT AtomicFiles {
 public:
  explicit AtomicFiles(const Target& target, AtomicFileOptions options = {});
  ~AtomicFiles();
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;

  std::unique_ptr<AtomicFile> Make(const std::string& name);
  std::unique_ptr<AtomicFile> MakeTarget();
  void Commit();

  // The target, or what it leads to when it is a symbolic link.
  const std::string& target() const { return target_; }

 private:
  std::string path_, target_;
  AtomicFileOptions options_;
  Target::Sink sink_;                             // takes what the target holds, where there is one
  std::unique_ptr<detail::FilesTogether> files_;  // null with a sink
};

}  // namespace slamdb
