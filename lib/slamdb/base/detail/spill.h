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

// For threads that go through an atlas, between its pieces: lets go of what of the spill file is in memory beyond the
// limit, sooner than the thread that looks after it does on a busy machine.
void LetGoOfSpilled();

}  // namespace slamdb::detail
