// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>

namespace slamdb::sqlite {

// The rollback journal of a transaction that did not end: the pages as they were before it. With them laid over the
// file and its length as recorded, the file is what it was after the last transaction that did.
// https://sqlite.org/fileformat2.html#the_rollback_journal
class RollbackJournal {
 public:
  RollbackJournal() = default;  // there is none
  // Reads the open file. One without a valid header is none: SQLite has overwritten it when the transaction ended.
  explicit RollbackJournal(int descriptor);

  bool empty() const { return page_bytes_ == 0; }
  // False: the journal breaks off, records differ from their checksums, or it is that of several databases. Then it has
  // no pages.
  bool whole() const { return whole_; }
  std::uint64_t page_bytes() const { return page_bytes_; }
  std::uint64_t pages() const { return pages_; }  // of the database before the transaction
  // Where in the journal a page of the database stands, pages counted from 1.
  std::optional<std::uint64_t> Find(std::uint32_t page) const;

 private:
  bool ReadRecords(int descriptor);

  std::uint64_t page_bytes_ = 0, pages_ = 0;
  bool whole_ = true;
  std::unordered_map<std::uint32_t, std::uint64_t> places_;
};

}  // namespace slamdb::sqlite
