// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>

#include "slamdb/export.h"

namespace slamdb::detail {

// A file beside the place where it belongs once it is whole: `.NAME.slamdb-` and 32 hex digits, of which the last half
// is the hash of what stands before it, so that no file of somebody else is taken for one. It is gone when this object
// goes.
//
// What kills a program leaves such a file behind. So it is locked (flock) while its writer lives, and
// RemoveDeadTemporaryFiles() removes those in a folder that nobody holds any more: regular files and folders of this
// user (of any, for the superuser), of such a name, with one link, whose lock is free, and which this run does not
// read. Locks of another machine cannot be seen on every network file system; on any file system that is not known to
// be local, a dead one goes only when it was not written for a day.
class TemporaryFile {
 public:
  // Beside `target`, which need not exist; `mode` as in open(), which the process' mask narrows. Errors name `path`.
  //
  // Throws Error (SystemError) when it cannot be made.
  TemporaryFile(const std::string& target, mode_t mode, const std::string& path);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_; }

  // Ends writing, which tells of what the system had put off; what close() returns. The lock stays.
  int Close();
  // Gives it the name `target`, where no file has that name, in one step.
  //
  // Throws Error: kAlreadyExists when somebody else has taken the name; as the system has it otherwise.
  void Claim(const std::string& target);
  // Gives it the name `target`, in place of a file that has it, in one step.
  //
  // Throws Error (SystemError).
  void Replace(const std::string& target);

 private:
  void Keep();

  std::string named_, path_;
  int descriptor_ = -1;
  int lock_ = -1;  // of the same open file, so that it stays locked until it is in place
  int slot_ = -1;  // among those that RemoveTemporaryFiles knows
};

// A folder beside the place where it belongs once it is whole, of such a name, locked and removed as a temporary file
// is, with all that is in it.
class TemporaryFolder {
 public:
  // Beside `target`; errors name `path`.
  //
  // Throws Error (SystemError) when it cannot be made.
  TemporaryFolder(const std::string& target, const std::string& path);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

  // Gives it the name `target`, where nothing or an empty folder is, in one step.
  //
  // Throws Error: kAlreadyExists when somebody has put files there; as the system has it otherwise.
  void Place(const std::string& target);
  // Gives it the name `target`, and what has it the name of this one, in one step. False: the system cannot.
  bool Exchange(const std::string& target);

 private:
  std::string named_, path_;
  int lock_ = -1;
  int slot_ = -1;
};

// Gives a file the name `to`, where no file has that name, in one step. False, with errno: EEXIST when somebody has
// taken the name.
bool RenameToNew(const std::string& from, const std::string& to);

// A place among the files that RemoveTemporaryFiles() removes, to be given back; -1: there is none left, so that only
// the next run removes what a signal leaves.
int TakeSlot(const std::string& path);
void GiveBackSlot(int slot);

// Makes the name of a new file survive a power cut. Errors name `path`.
//
// Throws Error (SystemError) when the folder cannot be synced; the file is there all the same.
void SyncFolderOf(const std::string& target, const std::string& path);

// What dead programs left in the folder where `target` is, but what a claim still needs. A process looks once into
// each, unless something was kept.
void RemoveDeadTemporaryFiles(const std::string& target);

// Removes the temporary files of this process. For a signal handler that ends the process right after.
SLAMDB_EXPORT void RemoveTemporaryFiles() noexcept;

}  // namespace slamdb::detail
