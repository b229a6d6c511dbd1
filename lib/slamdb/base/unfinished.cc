// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/unfinished.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kName = ".slamdb-unfinished";
constexpr std::string_view kFirstLine =
    "slamdb was replacing these files one after the other; some may be old, some new:";

// Whether the lock is free. A file system without locks has none that are held.
bool TryLock(int descriptor, int how) {
  while (::flock(descriptor, how | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    if (errno != EINTR) return true;
  }
  return true;
}

// The lines but the first. What is longer than any that slamdb writes is not read to its end.
std::vector<std::string> NamesIn(const std::string& unfinished) {
  constexpr std::size_t kMost = std::size_t{16} << 20;
  std::ifstream file(unfinished, std::ios::binary);
  std::string text(kMost, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  std::vector<std::string> names;
  for (std::size_t begin = text.find('\n'); begin != std::string::npos && begin + 1 < text.size();) {
    const std::size_t end = text.find('\n', ++begin);
    names.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return names;
}

void WriteAt(int descriptor, std::string_view text, const std::string& path) {
  ::lseek(descriptor, 0, SEEK_SET);
  const auto size = static_cast<off_t>(text.size());
  while (!text.empty()) {
    const ssize_t written = CallsOfFiles().write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemError(path, "cannot write");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::ftruncate(descriptor, size) != 0) throw SystemError(path, "cannot write");
}

Error Busy(const std::string& path) {
  return {ErrorKind::kLocked, path, "", "is being replaced by another program; try again when that is done"};
}

}  // namespace

std::string UnfinishedIn(const std::string& folder) {
  return (std::filesystem::path(folder) / std::string(kName)).string();
}

std::string UnfinishedBeside(const std::string& file) {
  const std::filesystem::path path = FollowLinks(file);
  return (FolderOf(path) / Concat(".", path.stem().string(), kName)).string();
}

bool IsUnfinished(const std::string& unfinished) {
  struct stat status {};
  return ::stat(unfinished.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
}

void RefuseUnfinished(const std::string& unfinished, const std::string& path, std::string_view below) {
  if (!IsUnfinished(unfinished)) return;
  const std::vector<std::string> names = NamesIn(unfinished);
  if (!below.empty() && std::ranges::none_of(names, [&](const auto& name) { return name.starts_with(below); })) return;
  const Descriptor file(::open(unfinished.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (file.value >= 0 && !TryLock(file.value, LOCK_SH)) throw Busy(path);
  throw Error(ErrorKind::kDamaged, path, "",
              Concat("a program that replaced its files was killed between two of them, so that some may be old and "
                     "some new; write it again, or remove ",
                     unfinished, ", which names them, if they do belong together"));
}

Unfinished::Unfinished(std::string unfinished, std::string path)
    : unfinished_(std::move(unfinished)), path_(std::move(path)) {
  while (!Lock()) ::close(std::exchange(descriptor_, -1));
  left_ = NamesIn(unfinished_);
  if (left_.empty()) slot_ = TakeSlot(unfinished_);
}

// False: whoever had it has removed it meanwhile.
bool Unfinished::Lock() {
  descriptor_ = ::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw SystemError(path_, "cannot make " + unfinished_);
  if (!TryLock(descriptor_, LOCK_EX)) {
    ::close(std::exchange(descriptor_, -1));
    throw Busy(path_);
  }
  return IsStillThere();
}

bool Unfinished::IsStillThere() const {
  struct stat opened {
  }, there{};
  return ::fstat(descriptor_, &opened) == 0 && ::lstat(unfinished_.c_str(), &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

void Unfinished::Begin(const std::vector<std::string>& names, bool sync) {
  std::string text = Concat(kFirstLine, "\n");
  for (const std::string& name : names) text += name + "\n";
  WriteAt(descriptor_, text, path_);
  if (sync && CallsOfFiles().fsync(descriptor_) != 0) throw SystemError(path_, "cannot be synced to disk");
  if (sync) SyncFolderOf(unfinished_, path_);
  begun_ = true;
  GiveBackSlot(std::exchange(slot_, -1));
}

// Emptied, too, as far as it goes: its removal may fail.
void Unfinished::Withdraw() {
  begun_ = false;
  [[maybe_unused]] const bool is_empty = left_.empty() && ::ftruncate(descriptor_, 0) == 0;
}

// What a program left that was killed is mended by that too. Emptied first: either may fail.
void Unfinished::Finish() {
  const bool is_empty = ::ftruncate(descriptor_, 0) == 0;
  if (!is_empty && IsStillThere() && CallsOfFiles().unlink(unfinished_.c_str()) != 0)
    throw SystemError(path_, Concat("is written, but cannot remove ", unfinished_));
  begun_ = false;
  left_.clear();
}

Unfinished::~Unfinished() {
  if (!begun_ && left_.empty() && IsStillThere()) CallsOfFiles().unlink(unfinished_.c_str());
  ::close(descriptor_);
  GiveBackSlot(slot_);
}

}  // namespace slamdb::detail
