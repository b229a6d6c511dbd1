// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "slamdb/export.h"

namespace slamdb {

// Memory for the columns of an atlas.
// Blocks are cut one behind the other from 2 MiB slabs that are backed by huge pages.
// A slab counts the blocks that live in it and goes back to the system with the last of them, so columns may be copied
// and moved between atlases and threads like any vector.
// Under AddressSanitizer this is plain operator new, so that overruns are seen.
//
// Throws std::bad_alloc; Error as SetMemoryLimit (memory.h) tells, by which slabs may be on disk.
// Cost: few page faults, and no malloc for each column.
// Thread-safe: each thread cuts from a slab of its own.
SLAMDB_EXPORT void* AllocateColumn(std::size_t bytes);
SLAMDB_EXPORT void FreeColumn(void* block, std::size_t bytes) noexcept;

// The stateless allocator over it.
// Elements without an initialiser of their own (numbers, Keypoint, Descriptor) are left uninitialised by `resize(n)`,
// because readers overwrite them at once; write `resize(n, value)` for a value.
template <class T>
struct ColumnAllocator {
  using value_type = T;
  static_assert(alignof(T) <= 16);

  ColumnAllocator() = default;
  template <class U>
  ColumnAllocator(const ColumnAllocator<U>&) {}  // NOLINT(google-explicit-constructor): what allocators do

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(AllocateColumn(count * sizeof(T)));
  }
  void deallocate(T* block, std::size_t count) noexcept { FreeColumn(block, count * sizeof(T)); }

  template <class U>
  void construct(U* place) noexcept(std::is_nothrow_default_constructible_v<U>) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }

  friend bool operator==(const ColumnAllocator&, const ColumnAllocator&) { return true; }
};

// A std::vector whose memory comes from slabs.
template <class T>
using Column = std::vector<T, ColumnAllocator<T>>;

}  // namespace slamdb
