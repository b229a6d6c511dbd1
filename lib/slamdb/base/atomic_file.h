// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/base/file.h"
#include "slamdb/export.h"

namespace slamdb {

namespace detail {
class TemporaryFile;
}

struct AtomicFileOptions {
  bool overwrite = false;  // replace a file that is there; otherwise Error
  bool sync = true;        // fsync file and folder, so that the file survives a power cut
  // Called when the file is whole and synced, right before it appears: for what must not be later than it, such as the
  // journal of how it was made. What it throws leaves the target as it was. May be empty.
  std::function<void()> before_commit;
};

// A file that appears whole or not at all: the one way by which everything but stores is written.
// Bytes go to a temporary file beside the target (`.NAME.slamdb-` and 32 hex digits), which Commit() syncs and renames
// over it. Without Commit() (an exception, a return) the temporary file is removed and the target is as it was. What a
// killed program left behind is removed by the next one that writes into that folder.
//
// Symbolic links are followed, also one that leads to nothing yet. The mode of a file that is replaced stays, and its
// owner and group where the system permits; where the group cannot stay, it is given no more than others have.
// Without `overwrite` the name is claimed at Commit(): of two who make the same new file one fails.
// An SQLite database is never replaced, with `overwrite` either, nor is one written where the log of another one lies.
//
// What is no regular file (a device, a pipe, `/dev/stdout`, `/dev/fd/3`) is opened and written into, needs no
// `overwrite`, and is never replaced. That, standard output and sinks get the bytes as they come, with nothing atomic
// about it.
//
// Throws Error: kAlreadyExists when the target is there and not `overwrite`, or is a database; kUsage when it is a
// directory or has no name; kNotFound (the folder), kOutOfResources (the disk is full) and kPermission as the system
// has it (SystemError). Throws whatever a sink throws.
class SLAMDB_EXPORT AtomicFile {
 public:
  explicit AtomicFile(const Target& target, AtomicFileOptions options = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(Bytes bytes);
  void Write(std::string_view text) { Write(std::as_bytes(std::span(text))); }
  // Throws Error also when the file is in place but its folder cannot be synced: a power cut may then lose it.
  void Commit();

  std::uint64_t size() const { return size_; }

 private:
  void Open();
  void OpenSpecial();
  void CommitSpecial();
  void Place();

  std::string path_;                                  // as the user named it
  std::string target_;                                // where the rename goes: the path with symbolic links followed
  std::unique_ptr<detail::TemporaryFile> temporary_;  // null for what is no regular file
  Target::Sink sink_;
  AtomicFileOptions options_;
  int descriptor_ = -1;
  bool special_ = false;  // a device, a pipe, an open file, which this object has opened
  std::uint64_t size_ = 0;
};

// Whether a path leads to what is there and no regular file: what is written there goes by, and has no file beside it.
SLAMDB_EXPORT bool IsSpecialFile(const std::string& path);

}  // namespace slamdb
