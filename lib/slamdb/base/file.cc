// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "slamdb/base/error.h"

namespace slamdb {
namespace {

// Closes a descriptor when the scope ends.
struct Descriptor {
  int value;
  explicit Descriptor(int opened) : value(opened) {}
  ~Descriptor() {
    if (value > STDERR_FILENO) ::close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

void* MapAnonymous(const std::string& path, std::size_t bytes) {
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw SystemError(path, "cannot reserve memory for the input");
  return memory;
}

// Reads a pipe to its end into an anonymous mapping that doubles as it fills.
Bytes ReadStandardInput(const std::string& path) {
  std::size_t capacity = std::size_t{1} << 20, size = 0;
  auto* memory = static_cast<std::byte*>(MapAnonymous(path, capacity));
  while (true) {
    const ssize_t got = ::read(STDIN_FILENO, memory + size, capacity - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      const Error error = SystemError(path, "cannot read standard input");
      ::munmap(memory, capacity);
      throw error;
    }
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (size < capacity) continue;
    void* larger = ::mremap(memory, capacity, capacity * 2, MREMAP_MAYMOVE);
    if (larger == MAP_FAILED) {
      ::munmap(memory, capacity);
      throw Error(path, "", "standard input does not fit into memory");
    }
    memory = static_cast<std::byte*>(larger);
    capacity *= 2;
  }
  if (size == 0) {
    ::munmap(memory, capacity);
    return {};
  }
  const std::size_t page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t kept = (size + page - 1) / page * page;
  if (kept < capacity) ::munmap(memory + kept, capacity - kept);
  return {memory, size};
}

Bytes MapRegularFile(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.value < 0) throw SystemError(path, "cannot open");
  struct stat status {};
  if (::fstat(file.value, &status) != 0) throw SystemError(path, "cannot read its size");
  if (S_ISDIR(status.st_mode)) throw Error(path, "", "is a directory, expected a file");
  if (!S_ISREG(status.st_mode)) throw Error(path, "", "is not a regular file; pipe it in and name the input `-`");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return {};
  void* memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.value, 0);
  if (memory == MAP_FAILED) throw SystemError(path, "cannot map");
  ::madvise(memory, size, MADV_SEQUENTIAL);
  return {static_cast<const std::byte*>(memory), size};
}

std::string FolderOf(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void WriteAll(const std::string& path, int descriptor, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemError(path, "cannot write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace

MappedFile::MappedFile(const std::string& path)
    : path_(path), bytes_(path == "-" ? ReadStandardInput(path) : MapRegularFile(path)) {}

MappedFile::~MappedFile() {
  if (bytes_.data() != nullptr) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)), bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

AtomicFile::AtomicFile(const std::string& path, AtomicFileOptions options) : path_(path), options_(options) {
  if (path_ == "-") {
    descriptor_ = STDOUT_FILENO;
    return;
  }
  std::error_code ignored;
  const std::filesystem::path followed = std::filesystem::weakly_canonical(path_, ignored);
  target_ = followed.empty() ? path_ : followed.string();
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) throw Error(path_, "", "is a directory, expected a file to write");
  if (exists && !options_.overwrite)
    throw Error(ErrorKind::kAlreadyExists, path_, "", "is there already; WriteOptions::overwrite replaces it");
  temporary_ = target_ + ".XXXXXX";
  descriptor_ = ::mkostemp(temporary_.data(), O_CLOEXEC);
  if (descriptor_ < 0) throw SystemError(path_, "cannot create a temporary file in " + FolderOf(target_));
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor_, exists ? status.st_mode & 07777 : 0666 & ~mask);
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty() || descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::Write(Bytes bytes) {
  WriteAll(path_, descriptor_, bytes);
  size_ += bytes.size();
}

void AtomicFile::Commit() {
  if (temporary_.empty()) return;
  if (options_.sync && ::fsync(descriptor_) != 0) throw SystemError(path_, "cannot sync to disk");
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (closed != 0 || ::rename(temporary_.c_str(), target_.c_str()) != 0) {
    const Error error = SystemError(path_, "cannot rename the finished file into place");
    ::unlink(temporary_.c_str());
    throw error;
  }
  if (!options_.sync) return;
  const Descriptor folder(::open(FolderOf(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.value >= 0) ::fsync(folder.value);
}

Probe Probe::Of(const std::string& path) {
  Probe probe{.path = path, .head = {}};
  if (path == "-") return probe;
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.value < 0) throw SystemError(path, "cannot open");
  struct stat status {};
  if (::fstat(file.value, &status) != 0) throw SystemError(path, "cannot read its size");
  probe.is_directory = S_ISDIR(status.st_mode);
  if (probe.is_directory) return probe;
  probe.size = static_cast<std::uint64_t>(status.st_size);
  std::array<char, 4096> head{};
  const ssize_t got = ::pread(file.value, head.data(), head.size(), 0);
  if (got > 0) probe.head.assign(head.data(), static_cast<std::size_t>(got));
  return probe;
}

}  // namespace slamdb
