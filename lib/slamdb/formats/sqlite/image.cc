// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/image.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

#include "slamdb/base/error.h"
#include "slamdb/formats/sqlite/detail/big_endian.h"
#include "slamdb/formats/sqlite/detail/log_index.h"
#include "slamdb/formats/sqlite/detail/rollback_journal.h"

namespace slamdb::sqlite {
namespace {

constexpr std::uint64_t kPageBytesAt = 16, kReadVersionAt = 19, kWriteVersionAt = 18, kPagesAt = 28;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;  // of what a damaged header may promise

bool IsSame(const struct stat& a, const struct stat& b) {
  return a.st_size == b.st_size && a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

bool IsSameNow(const std::string& path, const struct stat& before) {
  struct stat now {};
  const bool exists = ::stat(path.c_str(), &now) == 0;
  return exists ? now.st_ino == before.st_ino && IsSame(now, before) : before.st_ino == 0;
}

// Zeros behind the end. False: the disk fails.
bool ReadZeroed(int descriptor, std::uint64_t place, std::span<std::byte> bytes) {
  const ssize_t got = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place));
  std::ranges::fill(bytes.subspan(got < 0 ? 0 : static_cast<std::size_t>(got)), std::byte{0});
  return got >= 0;
}

}  // namespace

// Closing a descriptor of one's own would end the locks that other connections of this process hold on the file
// (fcntl(2)), so that SQLite opens and closes it. Nobody locks the log.
DatabaseFile::DatabaseFile(const std::string& path) {
  sqlite3_initialize();
  sqlite3_vfs* system = sqlite3_vfs_find(nullptr);
  memory_ = std::make_unique<std::byte[]>(static_cast<std::size_t>(system->szOsFile));
  file_ = reinterpret_cast<sqlite3_file*>(memory_.get());
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
  int opened = flags;
  const int code = system->xOpen(system, path.c_str(), file_, flags, &opened);
  if (code != SQLITE_OK) throw Error(ErrorKind::kPermission, path, "", "cannot open");
}

DatabaseFile::~DatabaseFile() { file_->pMethods->xClose(file_); }

bool DatabaseFile::Read(std::uint64_t place, std::span<std::byte> bytes) const {
  const int code =
      file_->pMethods->xRead(file_, bytes.data(), static_cast<int>(bytes.size()), static_cast<sqlite3_int64>(place));
  return code == SQLITE_OK || code == SQLITE_IOERR_SHORT_READ;  // which leaves zeros
}

Image::Image(const std::string& path, Missing missing) : path_(path), beside_(path), file_(path) {
  ::stat(path.c_str(), &state_);
  log_file_ = ::open(beside_.log.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (log_file_ >= 0 && ReadZeroed(log_file_, 0, log_header_)) pages_beside_ = IndexLog(log_file_);
  journal_file_ = ::open(beside_.journal.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  RollbackJournal journal;
  if (journal_file_ >= 0 && ::fstat(journal_file_, &journal_state_) == 0) journal = ReadRollbackJournal(journal_file_);
  lacks_journal_ = !journal.whole;
  takes_back_ = is_alone() && journal.before.page_bytes > 0 && file_bytes() > 0;
  if (takes_back_) pages_beside_ = std::move(journal.before);
  FindSizes(missing);
}

Image::~Image() {
  if (log_file_ >= 0) ::close(log_file_);
  if (journal_file_ >= 0) ::close(journal_file_);
}

// Page size and pages stand in the first page, big-endian; after a commit to the log, there.
void Image::FindSizes(Missing missing) {
  page_bytes_ = pages_beside_.page_bytes;
  std::array<unsigned char, 32> header{};
  Read(0, std::as_writable_bytes(std::span(header)));
  const std::uint64_t recorded = BigEndian32(&header[kPageBytesAt]) >> 16;
  if (page_bytes_ == 0) page_bytes_ = recorded == 1 ? 65536 : recorded;
  promised_ = page_bytes_ * (is_alone() ? BigEndian32(&header[kPagesAt]) : pages_beside_.pages);
  if (promised_ > kMostBytes) promised_ = 0;
  size_ = is_alone() ? file_bytes() : promised_;
  if (missing == Missing::kIsZeros) size_ = std::max(size_, promised_);
}

// Frames that are added to a log do not matter; one that is begun anew has other salts in its header.
bool Image::changed() const {
  if (!IsSameNow(path_, state_)) return true;
  if (is_alone()) return false;
  if (takes_back_) return !IsSameNow(beside_.journal, journal_state_);
  LogHeader header{};
  return !ReadZeroed(log_file_, 0, header) || header != log_header_;
}

bool Image::lacks_pages() const {
  if (page_bytes_ == 0) return false;
  for (std::uint64_t page = file_bytes() / page_bytes_; page < promised_ / page_bytes_; ++page)
    if (!PlaceBeside(static_cast<std::uint32_t>(page + 1))) return true;
  return false;
}

std::optional<std::uint64_t> Image::PlaceBeside(std::uint32_t page) const {
  const auto found = pages_beside_.places.find(page);
  return found == pages_beside_.places.end() ? std::nullopt : std::optional(found->second);
}

bool Image::Read(std::uint64_t place, std::span<std::byte> bytes) const {
  if (is_alone()) return file_.Read(place, bytes);
  for (std::uint64_t at = place; at < place + bytes.size();) {
    const std::uint64_t in_page = at % page_bytes_;
    const auto done = static_cast<std::size_t>(at - place);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size() - done, page_bytes_ - in_page));
    const auto beside = PlaceBeside(static_cast<std::uint32_t>(at / page_bytes_ + 1));
    const auto part = bytes.subspan(done, count);
    const int file_beside = takes_back_ ? journal_file_ : log_file_;
    if (!(beside ? ReadZeroed(file_beside, *beside + in_page, part) : file_.Read(at, part))) return false;
    at += count;
  }
  return true;
}

// ---- as SQLite sees it

namespace {

struct ImageFile {
  sqlite3_file base;
  Image* image;
};

Image& ImageOf(sqlite3_file* file) { return *reinterpret_cast<ImageFile*>(file)->image; }

int Close(sqlite3_file* file) {
  delete reinterpret_cast<ImageFile*>(file)->image;
  return SQLITE_OK;
}

// The log is part of the image, so that the file says of itself to have none: its format versions become those of a
// database with a rollback journal.
int Read(sqlite3_file* file, void* buffer, int count, sqlite3_int64 place) {
  const std::span bytes(static_cast<std::byte*>(buffer), static_cast<std::size_t>(count));
  const auto start = static_cast<std::uint64_t>(place);
  const Image& image = ImageOf(file);
  if (!image.Read(start, bytes)) return SQLITE_IOERR_READ;
  if (image.changed()) return SQLITE_BUSY;
  for (const std::uint64_t version : {kWriteVersionAt, kReadVersionAt})
    if (version >= start && version - start < bytes.size() && bytes[version - start] == std::byte{2})
      bytes[version - start] = std::byte{1};
  return start + bytes.size() > image.size() ? SQLITE_IOERR_SHORT_READ : SQLITE_OK;
}

int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  *size = static_cast<sqlite3_int64>(ImageOf(file).size());
  return SQLITE_OK;
}

constexpr sqlite3_io_methods kMethods = {
    .iVersion = 1,
    .xClose = Close,
    .xRead = Read,
    .xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; },
    .xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; },
    .xSync = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xFileSize = FileSize,
    .xLock = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xCheckReservedLock =
        [](sqlite3_file*, int* reserved) {
          *reserved = 0;
          return SQLITE_OK;
        },
    .xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; },
    .xSectorSize = [](sqlite3_file*) { return 4096; },
    .xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; },
};

template <Missing missing>
int Open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  file->pMethods = nullptr;
  if (name == nullptr || (flags & SQLITE_OPEN_MAIN_DB) == 0) return SQLITE_CANTOPEN;
  try {
    reinterpret_cast<ImageFile*>(file)->image = new Image(name, missing);
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  } catch (const Error&) {
    return SQLITE_CANTOPEN;
  }
  file->pMethods = &kMethods;
  if (out_flags != nullptr) *out_flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
  return SQLITE_OK;
}

// SQLite keeps the address of a VFS that it knows.
struct RegisteredVfs {
  RegisteredVfs(const char* name, decltype(sqlite3_vfs::xOpen) open) {
    sqlite3_initialize();
    vfs = *sqlite3_vfs_find(nullptr);
    vfs.pNext = nullptr;
    vfs.zName = name;
    vfs.szOsFile = sizeof(ImageFile);
    vfs.xOpen = open;
    sqlite3_vfs_register(&vfs, 0);
  }
  sqlite3_vfs vfs;
};

}  // namespace

const char* ImageVfs(Missing missing) {
  static const RegisteredVfs as_it_is("slamdb-image", Open<Missing::kIsDamage>);
  static const RegisteredVfs lengthened("slamdb-lengthened-image", Open<Missing::kIsZeros>);
  return (missing == Missing::kIsZeros ? lengthened : as_it_is).vfs.zName;
}

const Image& ImageSeenBy(sqlite3* handle) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(handle, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return ImageOf(file);
}

}  // namespace slamdb::sqlite
