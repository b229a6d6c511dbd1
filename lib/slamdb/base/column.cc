// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/column.h"

#include "slamdb/base/detail/sanitizers.h"

#if SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER  // they see overruns of blocks of their own alone

namespace slamdb {

void* AllocateColumn(std::size_t bytes) { return ::operator new(bytes); }
void FreeColumn(void* block, std::size_t) noexcept { ::operator delete(block); }

}  // namespace slamdb

#else

#include <sys/mman.h>

#include <atomic>
#include <cstdint>

#include "slamdb/base/detail/spill.h"
#include "slamdb/base/detail/spill_file.h"

namespace slamdb {
namespace {

constexpr std::size_t kSlabBytes = std::size_t{2} << 20;  // one huge page on x86-64 and most AArch64 kernels
constexpr std::size_t kLargeBytes = kSlabBytes / 4;       // from here on a block gets a mapping of its own
constexpr std::size_t kAlignment = 16;

// Stands at the start of each slab; a block finds it by clearing the low bits of its address.
struct Slab {
  std::atomic<std::size_t> users{0};  // blocks alive, plus one while a thread cuts from it
  std::size_t bytes = 0;              // of the whole mapping
  bool spilled = false;               // it is in the spill file
};
constexpr std::size_t kHeaderBytes = 64;
static_assert(sizeof(Slab) <= kHeaderBytes && kSlabBytes == detail::SpillFile::kAlignment);

Slab* SlabOf(void* block) {
  return reinterpret_cast<Slab*>(reinterpret_cast<std::uintptr_t>(block) & ~(kSlabBytes - 1));
}

// What does not fill a huge page gets its small pages in one call: hundreds of page faults cost as much as the reading.
// Older kernels refuse, and fault.
void FillTail([[maybe_unused]] char* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  const std::size_t huge = bytes / kSlabBytes * kSlabBytes;
  if (bytes > huge) ::madvise(begin + huge, bytes - huge, MADV_POPULATE_WRITE);
#endif
}

// Maps `bytes` (a multiple of the page size) aligned to kSlabBytes, by mapping more and giving the ends back.
char* MapMemory(std::size_t bytes) {
  const std::size_t mapped = bytes + kSlabBytes;
  void* raw = ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (raw == MAP_FAILED) {
    detail::GiveBackCounted(bytes);
    throw std::bad_alloc();
  }
  auto* begin = static_cast<char*>(raw);
  auto* aligned =
      reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(begin) + kSlabBytes - 1) & ~(kSlabBytes - 1));
  if (aligned != begin) ::munmap(begin, static_cast<std::size_t>(aligned - begin));
  char* end = aligned + bytes;
  if (end != begin + mapped) ::munmap(end, static_cast<std::size_t>(begin + mapped - end));
#ifdef MADV_HUGEPAGE
  ::madvise(aligned, bytes, MADV_HUGEPAGE);
#endif
  FillTail(aligned, bytes);
  return aligned;
}

Slab* MakeSlab(std::size_t bytes) {
  char* spilled = detail::SpillOrCount(bytes);
  Slab* slab = ::new (spilled != nullptr ? spilled : MapMemory(bytes)) Slab;
  slab->bytes = bytes;
  slab->spilled = spilled != nullptr;
  return slab;
}

void Release(Slab* slab) noexcept {
  if (slab->users.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  const std::size_t bytes = slab->bytes;
  if (slab->spilled) return detail::GiveBackSpilled(reinterpret_cast<char*>(slab), bytes);
  ::munmap(slab, bytes);
  detail::GiveBackCounted(bytes);
}

// The slab that this thread cuts from.
struct Cutter {
  Slab* slab = nullptr;
  char* next = nullptr;
  char* end = nullptr;

  ~Cutter() { Drop(); }
  void Drop() noexcept {
    if (slab != nullptr) Release(std::exchange(slab, nullptr));
    next = end = nullptr;
  }
  void* Cut(std::size_t bytes) {
    if (static_cast<std::size_t>(end - next) < bytes) {
      Slab* fresh = MakeSlab(kSlabBytes);
      Drop();
      slab = fresh;
      slab->users.store(1, std::memory_order_relaxed);
      next = reinterpret_cast<char*>(slab) + kHeaderBytes;
      end = reinterpret_cast<char*>(slab) + kSlabBytes;
    }
    slab->users.fetch_add(1, std::memory_order_relaxed);
    return std::exchange(next, next + bytes);
  }
};

thread_local Cutter cutter;

std::size_t Rounded(std::size_t bytes, std::size_t unit) {
  return bytes == 0 ? unit : (bytes + unit - 1) / unit * unit;
}

}  // namespace

void* AllocateColumn(std::size_t bytes) {
  const std::size_t rounded = Rounded(bytes, kAlignment);
  if (rounded < kLargeBytes) return cutter.Cut(rounded);
  Slab* slab = MakeSlab(Rounded(rounded + kHeaderBytes, 4096));
  slab->users.store(1, std::memory_order_relaxed);
  return reinterpret_cast<char*>(slab) + kHeaderBytes;
}

void FreeColumn(void* block, std::size_t bytes) noexcept {
  const std::size_t rounded = Rounded(bytes, kAlignment);
  char* begin = static_cast<char*>(block);
  // The newest block of this thread is given back in place: a vector that grows step by step wastes nothing.
  if (rounded < kLargeBytes && begin + rounded == cutter.next && SlabOf(block) == cutter.slab) cutter.next = begin;
  Release(SlabOf(block));
}

}  // namespace slamdb

#endif
