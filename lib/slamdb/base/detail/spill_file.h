// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/free_ranges.h"
#include "slamdb/base/memory.h"

namespace slamdb::detail {

// Memory on disk: a file that has no name, so that nothing is left of it however the process ends, and that is mapped
// whole into a range of addresses. A block has its room on the disk before it is given out, so that a full disk is an
// Error. What nobody has any more is punched out of the file.
//
// The process' resident memory is kept under a limit by letting pages of the file go, which is safe at any time: they
// are in the page cache, or on the disk, and come back when they are looked at. A hand walks round the file and lets go
// as it passes. It moves when a block is taken, and on a thread that looks while any is, the oftener the less is free
// under the limit.
//
// A fork leaves both processes what there is, as it is then: from there on the pages are each one's own where it
// writes, as those of other memory are. What is on the disk stays there until both have ended, and is let go by none.
// The process that forked takes its blocks behind it, the other takes none. Where the system gives no mapping more by
// which to keep the two apart, they share what they write, and none takes any or gives any back from there on.
//
// Thread-safe.
class SpillFile {
 public:
  static constexpr std::size_t kAlignment = std::size_t{2} << 20;

  // Throws Error when no file can be made in `folder` (SystemError), or when files there are in memory (kUsage).
  SpillFile(const std::string& folder, std::uint64_t limit);
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  // Null once the file is closed, as it is in a process that was forked. Throws Error (kOutOfResources) when the disk
  // is full.
  char* Take(std::size_t bytes);
  void GiveBack(char* block, std::size_t bytes) noexcept;

  // Keeps the memory under the limit now, unless another thread is at it.
  void LetGo();

  void SetLimit(std::uint64_t bytes) { limit_ = bytes; }
  Spilled Use();

  // Around fork(): before it, and behind it in both processes.
  void BeforeFork() {
    mutex_.lock();
    KeepForBoth();
  }
  void AfterFork() { mutex_.unlock(); }
  void BecomeChild() {
    closed_ = true;
    mutex_.unlock();
  }

 private:
  void Map();
  void Reserve(std::size_t begin, std::size_t bytes);
  void Unreserve(std::size_t begin, std::size_t bytes) noexcept;
  [[noreturn]] void FailToReserve(std::size_t bytes, int error) const;
  void Punch(std::size_t chunk) noexcept;
  void KeepForBoth();
  bool IsKept(std::size_t begin) const { return begin < kept_; }
  void StartWatching();
  void Watch();
  std::uint64_t Trim(std::uint64_t soon);
  void PassStep();

  std::string folder_;
  Descriptor file_;
  Descriptor statm_;  // of this process; not open: nothing is let go, and the system does so when it must
  char* map_ = nullptr;
  std::size_t map_bytes_ = 0;
  std::atomic<std::uint64_t> limit_;
  std::atomic<bool> closed_ = false;  // no block is taken any more, and nothing punched that was
  std::mutex mutex_;                  // guards the rest
  std::condition_variable changed_;
  bool stopped_ = false;
  FreeRanges ranges_;
  std::vector<std::size_t> taken_of_chunk_;  // bytes; a chunk of which none are has no room on the disk
  std::uint64_t taken_ = 0, most_ = 0;
  std::size_t hand_ = 0;
  std::uint64_t other_files_ = 0;  // pages of them in memory when this one was made, in bytes
  std::size_t kept_ = 0;           // bytes from the beginning that are as they were when this process forked
  std::thread watcher_;
};

}  // namespace slamdb::detail
