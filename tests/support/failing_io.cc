// SPDX-License-Identifier: BSD-3-Clause
//
// A library to preload: lets the nth call that changes files fail, or kills the process right before it.
//   SLAMDB_IO_AT=n          which call; without it all are only counted
//   SLAMDB_IO_HOW=kill|eio|enospc
//   SLAMDB_IO_LOG=file      how many there were, and the name of the one that failed
// Calls that tidy up (unlink) are counted for kills alone: nobody can tidy up on a disk that refuses it.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> calls = 0;
const char* failed = "none";

long At() {
  static const char* at = std::getenv("SLAMDB_IO_AT");
  return at == nullptr ? 0 : std::atol(at);
}

bool Is(const char* how) {
  static const char* asked = std::getenv("SLAMDB_IO_HOW");
  return asked != nullptr && std::strcmp(asked, how) == 0;
}

// Whether this call is to fail, with errno as it should be.
bool Fails(const char* call) {
  if (++calls != At()) return false;
  failed = call;
  if (Is("kill")) ::kill(::getpid(), SIGKILL);
  errno = Is("enospc") ? ENOSPC : EIO;
  return true;
}

template <class Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

struct Log {
  ~Log() {
    const char* path = std::getenv("SLAMDB_IO_LOG");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    std::fprintf(file, "%ld %s\n", calls.load(), failed);
    std::fclose(file);
  }
} log_at_the_end;

}  // namespace

#define SLAMDB_REAL(name) static auto* real = Real<decltype(::name)>(#name)

extern "C" {

ssize_t write(int file, const void* bytes, size_t size) {
  SLAMDB_REAL(write);
  return file > STDERR_FILENO && Fails("write") ? -1 : real(file, bytes, size);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  SLAMDB_REAL(pwrite);
  return Fails("pwrite") ? -1 : real(file, bytes, size, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  SLAMDB_REAL(pwrite64);
  return Fails("pwrite") ? -1 : real(file, bytes, size, at);
}
int fsync(int file) {
  SLAMDB_REAL(fsync);
  return Fails("fsync") ? -1 : real(file);
}
int fdatasync(int file) {
  SLAMDB_REAL(fdatasync);
  return Fails("fdatasync") ? -1 : real(file);
}
int ftruncate(int file, off_t size) {
  SLAMDB_REAL(ftruncate);
  return Fails("ftruncate") ? -1 : real(file, size);
}
int ftruncate64(int file, off64_t size) {
  SLAMDB_REAL(ftruncate64);
  return Fails("ftruncate") ? -1 : real(file, size);
}
int close(int file) {
  SLAMDB_REAL(close);
  if (file <= STDERR_FILENO || (::fcntl(file, F_GETFL) & O_ACCMODE) == O_RDONLY || !Fails("close")) return real(file);
  const int error = errno;
  real(file);
  errno = error;
  return -1;
}
int rename(const char* from, const char* to) {
  SLAMDB_REAL(rename);
  return Fails("rename") ? -1 : real(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned int flags) {
  SLAMDB_REAL(renameat2);
  return Fails("renameat2") ? -1 : real(from_folder, from, to_folder, to, flags);
}
int link(const char* from, const char* to) {
  SLAMDB_REAL(link);
  return Fails("link") ? -1 : real(from, to);
}
int unlink(const char* path) {
  SLAMDB_REAL(unlink);
  if (Is("kill")) Fails("unlink");
  return real(path);
}

}  // extern "C"
