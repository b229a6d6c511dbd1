// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sqlite3.h>
#include <sys/stat.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/pages_beside.h"

// A database and its write-ahead log, or the journal of a transaction that did not end, as one file that nobody writes:
// for stores that cannot be written, since SQLite itself would want to lay files beside them, and for damaged ones.
// Nothing is copied, locked or made.
namespace slamdb::sqlite {

// What to do about a file that is shorter than its header says.
enum class Missing {
  kIsDamage,  // SQLite refuses it
  kIsZeros,   // its end is pages of zeros, which read as damaged ones
};

// The file of a database.
class DatabaseFile {
 public:
  // Throws Error (kPermission).
  explicit DatabaseFile(const std::string& path);
  ~DatabaseFile();
  DatabaseFile(const DatabaseFile&) = delete;
  DatabaseFile& operator=(const DatabaseFile&) = delete;

  // Fills `bytes` with what stands at `place`, zeros behind the end. False: the disk fails.
  bool Read(std::uint64_t place, std::span<std::byte> bytes) const;

 private:
  std::unique_ptr<std::byte[]> memory_;
  sqlite3_file* file_ = nullptr;
};

class Image {
 public:
  // Throws Error (kPermission) when the file cannot be opened.
  Image(const std::string& path, Missing missing);
  ~Image();
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  // Fills `bytes` with what stands at `place`, zeros behind the end. False: the disk fails.
  bool Read(std::uint64_t place, std::span<std::byte> bytes) const;
  std::uint64_t size() const { return size_; }
  // Whether the file or its log was written since this was opened, so that what was read is not of one moment.
  bool changed() const;

  std::uint64_t file_bytes() const { return static_cast<std::uint64_t>(state_.st_size); }
  std::uint64_t promised_bytes() const { return promised_; }  // that its header or its log says it has; 0: no database
  bool lacks_pages() const;                                   // that were promised, and are not beside it either
  // Whether a journal lies beside it that cannot take back what a transaction that did not end had changed.
  bool lacks_journal() const { return lacks_journal_; }

 private:
  void FindSizes(Missing missing);
  bool is_alone() const { return pages_beside_.page_bytes == 0; }  // the file
  // Where a page stands in the log or the journal.
  std::optional<std::uint64_t> PlaceBeside(std::uint32_t page) const;

  using LogHeader = std::array<std::byte, 32>;

  std::string path_;
  FilesBeside beside_;
  DatabaseFile file_;
  int log_file_ = -1, journal_file_ = -1;
  struct stat state_ {
  }, journal_state_{};  // when they were opened
  LogHeader log_header_{};
  PagesBeside pages_beside_;  // of the log, or else of the journal
  bool takes_back_ = false;   // what the journal has
  bool lacks_journal_ = false;
  std::uint64_t page_bytes_ = 0, promised_ = 0, size_ = 0;
};

// The VFS of SQLite through which a connection sees the Image of a file; such a connection cannot write.
// SQLITE_BUSY there means that the image has changed.
const char* ImageVfs(Missing missing);

// What a connection through ImageVfs sees; lives as long as the connection.
const Image& ImageSeenBy(sqlite3* handle);

}  // namespace slamdb::sqlite
