// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/memory.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <new>

#include "slamdb/base/detail/free_memory.h"
#include "slamdb/base/detail/spill.h"
#include "slamdb/base/detail/spill_file.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::size_t kNotAskedFor = std::size_t{64} << 20;  // of columns, before the system is asked what is free
constexpr std::size_t kBesideColumns = std::size_t{512} << 20;
constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

// Of columns in memory. Nothing is locked while these suffice.
constinit std::atomic<std::size_t> counted = 0, room = kNotAskedFor;
constinit std::atomic<bool> known = false;  // whether `room` is of the limit
// Once made, for ever: columns may go later than all that is static.
constinit std::atomic<detail::SpillFile*> spill_file = nullptr;

struct Limit {
  std::mutex mutex;  // guards the rest
  MemoryLimit asked;
  std::uint64_t bytes = kUnlimited;  // once it is known
};

Limit* MakeLimit();

Limit& TheLimit() {
  static Limit* limit = MakeLimit();  // never destroyed either
  return *limit;
}

// A process that forks while another thread of it is at the limit or at the file leaves neither locked.
Limit* MakeLimit() {
  const auto before = [] {
    TheLimit().mutex.lock();
    if (detail::SpillFile* file = spill_file) file->BeforeFork();
  };
  const auto after = [] {
    if (detail::SpillFile* file = spill_file) file->AfterFork();
    TheLimit().mutex.unlock();
  };
  const auto in_child = [] {
    if (detail::SpillFile* file = spill_file) file->BecomeChild();
    TheLimit().mutex.unlock();
  };
  if (::pthread_atfork(before, after, in_child) != 0) throw std::bad_alloc();
  return new Limit;
}

// What columns may take in memory: the rest is for all else, and for what is looked at of those on disk.
std::size_t RoomUnder(std::uint64_t limit) {
  return limit - std::min(limit / 2, std::max<std::uint64_t>(limit / 4, kBesideColumns));
}

void Know(Limit& limit) {
  if (known) return;
  const std::uint64_t free = limit.asked.bytes > 0 ? 0 : detail::FreeMemory();
  limit.bytes = limit.asked.bytes > 0 ? limit.asked.bytes : free / 4 * 3;
  room = RoomUnder(limit.bytes);
  known = true;
  if (detail::SpillFile* file = spill_file) file->SetLimit(limit.bytes);
}

detail::SpillFile* MakeFile(const MemoryLimit& asked, std::uint64_t bytes) {
  if (!asked.spill_folder.empty()) return new detail::SpillFile(asked.spill_folder, bytes);
  if (const char* folder = std::getenv("TMPDIR"); folder != nullptr && *folder != '\0') {
    try {
      return new detail::SpillFile(folder, bytes);
    } catch (const Error&) {  // /var/tmp is for what is large
    }
  }
  return new detail::SpillFile("/var/tmp", bytes);
}

// Null where nothing was asked for and nothing can be done.
detail::SpillFile* FileUnder(const Limit& limit) {
  if (spill_file != nullptr || room == kUnlimited) return spill_file;
  try {
    spill_file = MakeFile(limit.asked, limit.bytes);
  } catch (const Error&) {
    if (limit.asked.bytes > 0 || !limit.asked.spill_folder.empty()) throw;
    room = kUnlimited;
    return nullptr;
  }
  return spill_file;
}

// Null when there is room after all, or no file.
char* Spill(std::size_t bytes) {
  detail::SpillFile* file = spill_file;
  if (file == nullptr || !known) {
    Limit& limit = TheLimit();
    const std::lock_guard lock(limit.mutex);
    Know(limit);
    if (counted.load(std::memory_order_relaxed) <= room) return nullptr;
    file = FileUnder(limit);
  }
  return file != nullptr ? file->Take(bytes) : nullptr;
}

}  // namespace

void SetMemoryLimit(const MemoryLimit& asked) {
  Limit& limit = TheLimit();
  const std::lock_guard lock(limit.mutex);
  limit.asked = asked;
  room = kNotAskedFor;
  known = false;
  if (asked.bytes > 0) Know(limit);
}

Spilled SpilledNow() {
  detail::SpillFile* const file = spill_file;
  return file != nullptr ? file->Use() : Spilled{};
}

namespace detail {

char* SpillOrCount(std::size_t bytes) {
  if (counted.fetch_add(bytes, std::memory_order_relaxed) + bytes <= room.load(std::memory_order_relaxed))
    return nullptr;
  char* block = nullptr;
  try {
    block = Spill(bytes);
  } catch (...) {
    GiveBackCounted(bytes);
    throw;
  }
  if (block != nullptr) GiveBackCounted(bytes);
  return block;
}

void GiveBackSpilled(char* block, std::size_t bytes) noexcept { spill_file.load()->GiveBack(block, bytes); }

void LetGoOfSpilled() {
  if (SpillFile* const file = spill_file.load(std::memory_order_relaxed)) file->LetGo();
}

void GiveBackCounted(std::size_t bytes) noexcept { counted.fetch_sub(bytes, std::memory_order_relaxed); }

}  // namespace detail
}  // namespace slamdb
