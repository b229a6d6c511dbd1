// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>

namespace slamdb::sqlite {

// Which pages the write-ahead log of a database holds, up to its last commit, and where: as SQLite's format of that
// file has it (sqlite.org/fileformat2.html, section 4), checksums included. What follows a torn frame is no part of it.
class LogIndex {
 public:
  LogIndex() = default;  // of a database without log
  explicit LogIndex(int descriptor);

  bool empty() const { return places_.empty(); }
  std::uint32_t page_bytes() const { return page_bytes_; }  // 0 when empty
  std::uint32_t pages() const { return pages_; }            // of the database after the last commit
  // Where in the log the newest committed version of a page begins; pages count from 1.
  std::optional<std::uint64_t> Find(std::uint32_t page) const;

 private:
  std::uint32_t page_bytes_ = 0, pages_ = 0;
  std::unordered_map<std::uint32_t, std::uint64_t> places_;
};

}  // namespace slamdb::sqlite
