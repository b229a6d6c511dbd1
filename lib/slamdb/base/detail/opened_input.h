// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "slamdb/base/detail/descriptor.h"

namespace slamdb::detail {

// Whether the bytes of a path come once: `-`, and what is there but neither a regular file nor a directory.
bool IsStream(const std::string& path);

// What a path leads to, open for reading: a regular file, or a stream, whose bytes come once and in order (`-` for
// standard input, a FIFO such as a process substitution, a character device, a file that does not know its size).
class OpenedInput {
 public:
  // Throws Error when the path is missing, a directory, a block device or a socket, or cannot be opened.
  explicit OpenedInput(const std::string& path);

  bool is_stream() const { return is_stream_; }
  std::uint64_t size() const { return size_; }  // of a regular file

  // Up to so many bytes from where reading stands; less only at the end. Throws Error, also for a FIFO that nobody
  // writes into within two seconds; a writer that is there is waited for as long as it takes.
  std::size_t Read(char* to, std::size_t bytes);
  // Of a regular file, from there; the place of Read() stays. Thread-safe.
  std::size_t ReadAt(std::uint64_t offset, char* to, std::size_t bytes) const;

 private:
  ssize_t ReadSome(char* to, std::size_t bytes);

  std::string path_;
  Descriptor file_;
  bool is_stream_ = false;
  // Of a FIFO from which nothing has come yet: whoever writes into it may not be there.
  enum class Writer { kKnown, kAwaited, kOverdue } writer_ = Writer::kKnown;
  std::uint64_t size_ = 0;
};

}  // namespace slamdb::detail
