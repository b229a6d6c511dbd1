// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace slamdb {

using Bytes = std::span<const std::byte>;

// A file mapped for reading. Opening never changes it. `-` reads the whole of standard input into memory.
// Throws Error when the path is missing, a directory, not a regular file, or not readable.
// A file that another program shortens while it is mapped raises SIGBUS, as with every mapping.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  Bytes bytes() const { return bytes_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Bytes bytes_;
};

struct AtomicFileOptions {
  bool overwrite = false;  // replace a file that is there; otherwise Error
  bool sync = true;        // fsync file and folder, so that the file survives a power cut
};

// A file that appears whole or not at all: bytes go to a temporary file beside the target, which Commit() syncs and
// renames over it. Without Commit() (an exception, a return) the temporary file is removed and the target is as it was.
// The target `-` writes to standard output instead, with nothing atomic about it.
// Throws Error: target there and not `overwrite`, target a directory, folder missing, disk full, no permission.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path, AtomicFileOptions options = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(Bytes bytes);
  void Write(std::string_view text) { Write(std::as_bytes(std::span(text))); }
  void Commit();

  std::uint64_t size() const { return size_; }

 private:
  std::string path_;       // as the user named it
  std::string target_;     // where the rename goes: the path with symbolic links followed
  std::string temporary_;  // empty for standard output
  AtomicFileOptions options_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

// The first bytes of a file and its path: what a format looks at to say whether a file is its own.
struct Probe {
  std::string path;
  std::string head;        // up to 4096 bytes
  std::uint64_t size = 0;  // of the file
  bool is_directory = false;

  // Throws Error when the path is missing or not readable. Standard input (`-`) gives an empty head.
  static Probe Of(const std::string& path);
};

}  // namespace slamdb
