// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/base/file.h"
#include "slamdb/export.h"

namespace slamdb {

struct AtomicFileOptions {
  bool overwrite = false;  // replace a file that is there; otherwise Error
  bool sync = true;        // fsync file and folder, so that the file survives a power cut
  // Called when the file is whole and synced, right before it appears: for what must not be later than it, such as the
  // journal of how it was made. What it throws leaves the target as it was. May be empty.
  std::function<void()> before_commit;
};

// A file that appears whole or not at all.
// Bytes go to a temporary file beside the target, which Commit() syncs and renames over it.
// Without Commit() (an exception, a return) the temporary file is removed and the target is as it was.
// Standard output and sinks get the bytes as they come, with nothing atomic about it.
//
// Throws Error: kAlreadyExists when the target is there and not `overwrite`; kUsage when it is a directory; kNotFound
// (the folder), kOutOfResources (the disk is full) and kPermission as the system has it (SystemError).
// Throws whatever a sink throws.
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
  void CreateTemporary();
  void Place();
  void SyncFolder();

  std::string path_;       // as the user named it
  std::string target_;     // where the rename goes: the path with symbolic links followed
  std::string temporary_;  // empty for standard output and sinks
  Target::Sink sink_;
  AtomicFileOptions options_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace slamdb
