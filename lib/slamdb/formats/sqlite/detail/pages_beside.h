// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstdint>
#include <span>
#include <unordered_map>

namespace slamdb::sqlite {

// Pages of a database that stand in another file beside it, and are laid over its own.
struct PagesBeside {
  std::uint64_t page_bytes = 0;                             // 0: there are none
  std::uint64_t pages = 0;                                  // of the database with these
  std::unordered_map<std::uint32_t, std::uint64_t> places;  // by page, counted from 1: where in that file it begins
};

// Whether there are as many bytes.
inline bool ReadAt(int descriptor, std::uint64_t place, std::span<unsigned char> bytes) {
  return ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place)) ==
         static_cast<ssize_t>(bytes.size());
}

}  // namespace slamdb::sqlite
