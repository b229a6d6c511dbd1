// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

// Where the slabs of columns go: into memory while there is room under the MemoryLimit, then into the spill file.
namespace slamdb::detail {

// A place in the spill file, aligned to 2 MiB; or null when the bytes are to be in memory, where they count from now
// on. Throws Error as SetMemoryLimit tells.
char* SpillOrCount(std::size_t bytes);
void GiveBackSpilled(char* block, std::size_t bytes) noexcept;
void GiveBackCounted(std::size_t bytes) noexcept;

}  // namespace slamdb::detail
