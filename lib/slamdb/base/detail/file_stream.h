// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/file.h"

namespace slamdb::detail {

// A file read from front to back through a window: its bytes appear at fixed addresses [data(), data() + size()), of
// which those between the last Release() and filled() can be looked at. Memory is that of the window; the huge pages of
// what was released are moved to where reading goes on, so that the kernel neither clears nor finds new ones. That is
// several times faster than mapping the file, whose page faults cost more than copying it, and a file that somebody
// shortens meanwhile is an Error instead of a SIGBUS. A stream (`-`, a FIFO) is read whole; bytes in memory are filled
// from the start and stay where they are.
// What is large and wanted elsewhere need not go through the window: LeaveOut() leaves a hole there, and Copy() reads
// it straight to where it belongs.
// FillTo() and LeaveOut() belong to one thread; Release() and Copy() may be called from any.
class FileStream {
 public:
  // `look` sees the beginning of a stream. Throws Error as WholeFile does.
  explicit FileStream(const Source& source, const WholeFile::Look& look = {});
  ~FileStream();
  FileStream(const FileStream&) = delete;
  FileStream& operator=(const FileStream&) = delete;

  const std::string& path() const { return path_; }
  const char* data() const { return data_; }
  std::size_t size() const { return size_; }  // of the whole file
  std::size_t filled() const { return filled_; }

  // Reads until at least `offset` bytes are filled, or the whole file. Throws Error.
  void FillTo(std::size_t offset);
  // The bytes from filled() to `offset`, not beyond the end, are not looked at, but copied. Bytes in memory stay.
  void LeaveOut(std::size_t offset);
  // Of what is filled or left out. Throws Error.
  void Copy(std::size_t offset, std::size_t bytes, char* to);
  // Nobody looks at bytes before `offset` any more.
  void Release(std::size_t offset);

 private:
  struct Hole {
    std::size_t begin, end;
  };

  void ReserveAddresses(std::size_t bytes);
  void AddBlock();
  Hole FirstHole(std::size_t begin, std::size_t end);
  void ReadAt(std::size_t offset, char* to, std::size_t bytes) const;

  std::string path_;
  std::optional<OpenedInput> file_;  // a regular one
  std::optional<WholeFile> stream_;
  char* reserved_ = nullptr;  // the whole range of addresses, with room to align
  std::size_t reserved_bytes_ = 0;
  char* window_ = nullptr;      // in that range, aligned to blocks; null for bytes in memory
  const char* data_ = nullptr;  // the window, or the bytes in memory
  std::size_t size_ = 0, filled_ = 0;
  std::size_t backed_ = 0;    // bytes behind data_ that have had memory
  std::mutex mutex_;          // guards the rest
  std::size_t released_ = 0;  // blocks given back
  std::vector<char*> spare_;  // of those, the ones not yet used again
  std::deque<Hole> holes_;    // behind what is released, ascending
};

}  // namespace slamdb::detail
