// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/temporary_file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <mutex>
#include <random>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kMark = ".slamdb-";
constexpr std::size_t kHexDigits = 16;  // of a random number, and of the hash of the name up to there
constexpr std::time_t kDay = 24 * 60 * 60;

// ---- names

std::string HashOfName(std::string_view beginning) { return Hex(HashBytes(std::as_bytes(std::span(beginning)))); }

std::string NameFor(const std::string& target) {
  const std::filesystem::path path(target);
  const std::string name = path.filename().string().substr(0, NAME_MAX - 1 - kMark.size() - 2 * kHexDigits);
  static thread_local std::mt19937_64 random{std::random_device{}()};
  std::string made = Concat(".", name, kMark, Hex(random()));
  made += HashOfName(made);
  return (path.parent_path() / made).string();
}

// No name that somebody else thought of ends with the hash of its beginning.
bool IsTemporaryName(std::string_view name) {
  if (name.size() <= kMark.size() + 2 * kHexDigits || name.front() != '.') return false;
  const std::string_view beginning = name.substr(0, name.size() - kHexDigits);
  return beginning.substr(beginning.size() - kHexDigits - kMark.size(), kMark.size()) == kMark &&
         name.substr(beginning.size()) == HashOfName(beginning);
}

// ---- what a signal handler removes: places for names, written only by whoever has taken them

struct Slot {
  std::atomic<bool> taken = false, filled = false;
  std::array<char, PATH_MAX> path{};
};

// There before main(): a handler cannot wait for what another thread is about to construct.
constinit std::array<Slot, 64> slots;

// ---- removal, also where nothing but system calls is allowed: in a signal handler

// What getdents64 gives: the system's own struct has no name in its headers.
struct Entry {
  std::uint64_t inode;
  std::int64_t next;
  std::uint16_t size;
  std::uint8_t type;
  char name[1];
};

bool IsDots(const char* name) { return name[0] == '.' && (name[1] == 0 || (name[1] == '.' && name[2] == 0)); }

// A file, or a folder with what is in it. What is deeper than any format goes stays.
void RemoveTree(int folder, const char* name, int depth = 8) noexcept {
  if (::unlinkat(folder, name, 0) == 0 || depth == 0) return;
  const int inside = ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (inside < 0) return;
  alignas(Entry) std::array<char, 4096> block;
  for (bool removed = true; removed;) {  // from the beginning again: removing moves what is behind
    removed = false;
    ::lseek(inside, 0, SEEK_SET);
    const long bytes = ::syscall(SYS_getdents64, inside, block.data(), block.size());
    for (long at = 0; at < bytes;) {
      const auto* entry = reinterpret_cast<const Entry*>(block.data() + at);
      at += entry->size;
      if (IsDots(entry->name)) continue;
      RemoveTree(inside, entry->name, depth - 1);
      struct stat left {};
      removed = removed || ::fstatat(inside, entry->name, &left, AT_SYMLINK_NOFOLLOW) != 0;
    }
  }
  ::close(inside);
  ::unlinkat(folder, name, AT_REMOVEDIR);
}

// ---- locks

bool Lock(int descriptor, int how) {
  while (::flock(descriptor, how) != 0)
    if (errno != EINTR) return false;
  return true;
}

bool IsLocal(int descriptor) {
  constexpr std::array<unsigned long, 10> kLocal = {
      EXT4_SUPER_MAGIC, XFS_SUPER_MAGIC,    BTRFS_SUPER_MAGIC,       TMPFS_MAGIC,           RAMFS_MAGIC,
      F2FS_SUPER_MAGIC, 0x2fc12fc1 /*ZFS*/, 0xca451a4e /*bcachefs*/, OVERLAYFS_SUPER_MAGIC, 0x4d44 /*FAT*/};
  struct statfs system {};
  return ::fstatfs(descriptor, &system) == 0 &&
         std::ranges::find(kLocal, static_cast<unsigned long>(system.f_type)) != kLocal.end();
}

bool IsStillAt(const std::string& path, const struct stat& status) {
  struct stat now {};
  return ::lstat(path.c_str(), &now) == 0 && now.st_dev == status.st_dev && now.st_ino == status.st_ino;
}

// To write, which some locks need, or to read where the mode of what was to be replaced allows no more.
int OpenToLock(const std::string& path) {
  constexpr int kHow = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const int descriptor = ::open(path.c_str(), O_WRONLY | kHow);
  return descriptor >= 0 ? descriptor : ::open(path.c_str(), O_RDONLY | kHow);
}

void RemoveIfDead(const std::string& path) {
  const Descriptor file(OpenToLock(path));
  struct stat status {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0) return;
  // The superuser's belong to the owner of what they were to replace.
  const bool is_ours = status.st_uid == ::geteuid() || ::geteuid() == 0;
  const bool is_file = S_ISREG(status.st_mode) && status.st_nlink == 1;
  if ((!is_file && !S_ISDIR(status.st_mode)) || !is_ours) return;
  if (!IsLocal(file.value) && std::time(nullptr) - status.st_mtime < kDay) return;
  if (Lock(file.value, LOCK_EX | LOCK_NB) && IsStillAt(path, status)) RemoveTree(AT_FDCWD, path.c_str());
}

// What it holds may be all that is left of the files that a killed program was replacing.
bool IsClaimed(const std::filesystem::path& temporary) {
  const std::string name = temporary.filename().string();
  const std::filesystem::path target =
      temporary.parent_path() / name.substr(1, name.size() - 1 - kMark.size() - 2 * kHexDigits);
  return IsUnfinished(UnfinishedIn(target.string())) || IsUnfinished(UnfinishedBeside(target.string())) ||
         IsUnfinished(UnfinishedBeside(target.string() + ".suffix"));
}

Error CannotRename(const std::string& path) { return SystemError(path, "cannot rename the finished file into place"); }

}  // namespace

int TakeSlot(const std::string& path) {
  if (path.size() >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    Slot& slot = slots[i];
    if (slot.taken.exchange(true)) continue;
    std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
    slot.filled = true;
    return static_cast<int>(i);
  }
  return -1;
}

void GiveBackSlot(int index) {
  if (index < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(index)];
  slot.filled = false;
  slot.taken = false;
}

TemporaryFile::TemporaryFile(const std::string& target, mode_t mode, const std::string& path) : named_(path) {
  for (struct stat status{}; status.st_nlink == 0;) {  // until none takes a new one for a dead one before it is locked
    if (descriptor_ >= 0) ::close(descriptor_);
    do {
      path_ = NameFor(target);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) throw SystemError(path, "cannot create a temporary file in " + FolderOf(target).string());
    if (!Lock(descriptor_, LOCK_EX)) break;  // a file system without locks: nobody will take it for a dead one
    if (::fstat(descriptor_, &status) != 0) break;
  }
  lock_ = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  slot_ = TakeSlot(path_);
}

TemporaryFile::~TemporaryFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!path_.empty()) ::unlink(path_.c_str());
  if (lock_ >= 0) ::close(lock_);
  GiveBackSlot(slot_);
}

int TemporaryFile::Close() { return CallsOfFiles().close(std::exchange(descriptor_, -1)); }

// By a link where the file system has no such renaming.
bool RenameToNew(const std::string& from, const std::string& to) {
  if (CallsOfFiles().renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP) return false;
  if (CallsOfFiles().link(from.c_str(), to.c_str()) != 0) return false;
  ::unlink(from.c_str());
  return true;
}

void TemporaryFile::Claim(const std::string& target) {
  if (RenameToNew(path_, target)) return Keep();
  if (errno == EEXIST)
    throw Error(ErrorKind::kAlreadyExists, named_, "",
                "is there already, made by another program meanwhile; WriteOptions::overwrite replaces it");
  throw CannotRename(named_);
}

void TemporaryFile::Replace(const std::string& target) {
  if (CallsOfFiles().rename(path_.c_str(), target.c_str()) != 0) throw CannotRename(named_);
  Keep();
}

// It has another name now, and is no temporary file any more.
void TemporaryFile::Keep() {
  path_.clear();
  GiveBackSlot(std::exchange(slot_, -1));
}

TemporaryFolder::TemporaryFolder(const std::string& target, const std::string& path) : named_(path) {
  const auto cannot = [&] {
    return SystemError(path, "cannot create a temporary folder in " + FolderOf(target).string());
  };
  for (struct stat status{};;) {  // until none takes a new one for a dead one before it is locked
    path_ = NameFor(target);
    if (::mkdir(path_.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      throw cannot();
    }
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 && errno != ENOENT) throw cannot();
    if (lock_ >= 0 && (!Lock(lock_, LOCK_EX) || (::fstat(lock_, &status) == 0 && IsStillAt(path_, status)))) break;
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  }
  slot_ = TakeSlot(path_);
}

TemporaryFolder::~TemporaryFolder() {
  if (!path_.empty()) RemoveTree(AT_FDCWD, path_.c_str());
  if (lock_ >= 0) ::close(lock_);
  GiveBackSlot(slot_);
}

// rename() replaces an empty folder, and no other.
void TemporaryFolder::Place(const std::string& target) {
  if (CallsOfFiles().rename(path_.c_str(), target.c_str()) != 0) {
    if (errno == ENOTEMPTY || errno == EEXIST)
      throw Error(ErrorKind::kAlreadyExists, named_, "", "holds files by now, made by another program meanwhile");
    throw CannotRename(named_);
  }
  path_.clear();
  GiveBackSlot(std::exchange(slot_, -1));
}

bool TemporaryFolder::Exchange(const std::string& target) {
  return CallsOfFiles().renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0;
}

void RemoveDeadTemporaryFiles(const std::string& target) {
  static std::mutex mutex;
  static std::set<std::tuple<dev_t, ino_t, std::string>> done;  // by path, too: the system gives numbers again
  const std::filesystem::path folder = FolderOf(target);
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) return;
  const std::lock_guard lock(mutex);
  const auto [looked, is_first] = done.emplace(status.st_dev, status.st_ino, folder.string());
  if (!is_first) return;
  bool kept = false;
  std::error_code unreadable;
  for (std::filesystem::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable))
    if (IsTemporaryName(entry->path().filename().native()) && !IsOfThisRun(entry->path().native())) {
      const bool claimed = IsClaimed(entry->path());
      kept = kept || claimed;
      if (!claimed) RemoveIfDead(entry->path().native());
    }
  if (kept) done.erase(looked);
}

void RemoveTemporaryFiles() noexcept {
  for (const Slot& slot : slots)
    if (slot.filled) RemoveTree(AT_FDCWD, slot.path.data());
}

void SyncFolderOf(const std::string& target, const std::string& path) {
  const std::string folder = FolderOf(target).string();
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.value >= 0 && CallsOfFiles().fsync(opened.value) == 0) return;
  if (opened.value >= 0 && errno == EINVAL) return;  // a file system that has no way to sync a folder
  throw SystemError(path, Concat("is written, but its folder ", folder,
                                 " cannot be synced to disk, so that a power cut may lose the file"));
}

}  // namespace slamdb::detail
