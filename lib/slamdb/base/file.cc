// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

using detail::Descriptor;

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
      throw Error(ErrorKind::kOutOfResources, path, "", "standard input does not fit into memory");
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
  if (S_ISDIR(status.st_mode)) throw Error(ErrorKind::kUsage, path, "", "is a directory, expected a file");
  if (!S_ISREG(status.st_mode))
    throw Error(ErrorKind::kUsage, path, "", "is not a regular file; pipe it in and name the input `-`");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return {};
  void* memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.value, 0);
  if (memory == MAP_FAILED) throw SystemError(path, "cannot map");
  ::madvise(memory, size, MADV_SEQUENTIAL);
  return {static_cast<const std::byte*>(memory), size};
}

}  // namespace

MappedFile::MappedFile(const Source& source) : path_(source.path), mapped_(!source.memory) {
  if (source.is_file()) detail::EnterInput(path_);
  if (source.memory)
    bytes_ = *source.memory;
  else
    bytes_ = source.is_file() ? MapRegularFile(path_) : ReadStandardInput(path_);
}

MappedFile::~MappedFile() {
  if (mapped_ && bytes_.data() != nullptr) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)), bytes_(std::exchange(other.bytes_, {})), mapped_(other.mapped_) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(bytes_, other.bytes_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

Probe Probe::Of(const Source& source) {
  constexpr std::size_t kHeadBytes = 4096;
  const std::string& path = source.path;
  Probe probe{.path = path, .head = {}, .memory = source.memory};
  if (source.memory) {
    const Bytes head = source.memory->first(std::min(source.memory->size(), kHeadBytes));
    probe.head.assign(reinterpret_cast<const char*>(head.data()), head.size());
    probe.size = source.memory->size();
  }
  if (!source.is_file()) return probe;
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.value < 0) throw SystemError(path, "cannot open");
  struct stat status {};
  if (::fstat(file.value, &status) != 0) throw SystemError(path, "cannot read its size");
  probe.is_directory = S_ISDIR(status.st_mode);
  if (probe.is_directory) return probe;
  probe.size = static_cast<std::uint64_t>(status.st_size);
  std::array<char, kHeadBytes> head{};
  const ssize_t got = ::pread(file.value, head.data(), head.size(), 0);
  if (got > 0) probe.head.assign(head.data(), static_cast<std::size_t>(got));
  return probe;
}

}  // namespace slamdb
