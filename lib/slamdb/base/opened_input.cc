// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/opened_input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr int kWaitForWriter = 2000;  // milliseconds

// Why what the path leads to is not read, or null.
const char* WhyNot(mode_t mode) {
  if (S_ISDIR(mode)) return "is a directory, expected a file";
  if (S_ISBLK(mode)) return "is a block device, expected a file; copy what is on it into one";
  if (S_ISSOCK(mode)) return "is a socket, expected a file; write what comes from it into one, or pipe it in";
  return nullptr;
}

void RefuseOthers(const std::string& path, mode_t mode) {
  if (const char* why = WhyNot(mode)) throw Error(ErrorKind::kUsage, path, "", why);
}

// Opens without waiting for the writer of a FIFO.
int Open(const std::string& path) {
  RequireFile(path);
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) RefuseOthers(path, status.st_mode);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) throw SystemError(path, "cannot open");
  return descriptor;
}

}  // namespace

bool IsStream(const std::string& path) {
  if (path == "-") return true;
  if (IsServer(path)) return false;
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

OpenedInput::OpenedInput(const std::string& path) : path_(path), file_(path == "-" ? STDIN_FILENO : Open(path)) {
  struct stat status {};
  if (::fstat(file_.value, &status) != 0) throw SystemError(path_, "cannot read its size");
  RefuseOthers(path_, status.st_mode);
  is_stream_ = path_ == "-" || !S_ISREG(status.st_mode) || status.st_size == 0;
  if (!is_stream_) size_ = static_cast<std::uint64_t>(status.st_size);
  if (path_ == "-") return;
  if (S_ISFIFO(status.st_mode))
    writer_ = Writer::kAwaited;
  else
    ::fcntl(file_.value, F_SETFL, 0);  // a device is waited for
}

std::size_t OpenedInput::Read(char* to, std::size_t bytes) {
  std::size_t size = 0;
  while (size < bytes) {
    const ssize_t got = ReadSome(to + size, bytes - size);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  return size;
}

std::size_t OpenedInput::ReadAt(std::uint64_t offset, char* to, std::size_t bytes) const {
  std::size_t size = 0;
  while (size < bytes) {
    const ssize_t got = ::pread(file_.value, to + size, bytes - size, static_cast<off_t>(offset + size));
    if (got < 0 && errno != EINTR) throw SystemError(path_, "cannot read");
    if (got == 0) break;
    if (got > 0) size += static_cast<std::size_t>(got);
  }
  return size;
}

// What can be had now, but at least a byte; 0 at the end.
ssize_t OpenedInput::ReadSome(char* to, std::size_t bytes) {
  pollfd input{.fd = file_.value, .events = POLLIN, .revents = 0};
  while (true) {
    const ssize_t got = ::read(file_.value, to, bytes);
    if (got == 0 && writer_ == Writer::kAwaited) {
      writer_ = ::poll(&input, 1, kWaitForWriter) == 0 ? Writer::kOverdue : Writer::kKnown;
      continue;
    }
    if (got == 0 && writer_ == Writer::kOverdue)
      throw Error(ErrorKind::kNotPossible, path_, "",
                  "is a FIFO that nothing writes into; start what writes into it first");
    writer_ = Writer::kKnown;
    if (got >= 0) return got;
    if (errno == EAGAIN || errno == EWOULDBLOCK)
      ::poll(&input, 1, -1);
    else if (errno != EINTR)
      throw SystemError(path_, path_ == "-" ? "cannot read standard input" : "cannot read");
  }
}

}  // namespace slamdb::detail
