// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{64} << 10;
constexpr std::size_t kFirstBytes = std::size_t{1} << 20;  // of memory for a stream, which doubles as it fills,
constexpr std::size_t kLargeStep = std::size_t{64} << 20;  // and grows by so much once it is large

// Memory that grows in place, or moves without being copied. Given back unless it is released.
class GrowingMemory {
 public:
  GrowingMemory(const std::string& path, std::size_t bytes) : path_(path), capacity_(bytes) {
    void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) Refuse();
    data_ = static_cast<char*>(memory);
  }
  ~GrowingMemory() {
    if (data_ != nullptr) ::munmap(data_, capacity_);
  }
  GrowingMemory(const GrowingMemory&) = delete;
  GrowingMemory& operator=(const GrowingMemory&) = delete;

  char* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }

  void Resize(std::size_t bytes) {
    void* moved = ::mremap(data_, capacity_, bytes, MREMAP_MAYMOVE);
    if (moved == MAP_FAILED) Refuse();
    data_ = static_cast<char*>(moved);
    capacity_ = bytes;
  }
  void Release() { data_ = nullptr; }

 private:
  [[noreturn]] void Refuse() const {
    throw Error(ErrorKind::kOutOfResources, path_, "", "the machine has too little memory left to read it");
  }

  const std::string& path_;
  char* data_ = nullptr;
  std::size_t capacity_;
};

// Reads to the end of a stream. Returns the number of bytes.
std::size_t ReadStream(detail::OpenedInput& input, const std::string& path, const WholeFile::Look& look,
                       GrowingMemory& memory) {
  std::size_t size = input.Read(memory.data(), kHeadBytes);
  if (look && size > 0) look(Probe::Of({Bytes(reinterpret_cast<const std::byte*>(memory.data()), size), path}));
  while (true) {
    const std::size_t wanted = memory.capacity() - size;
    const std::size_t got = input.Read(memory.data() + size, wanted);
    size += got;
    if (got < wanted) return size;
    if (size >= kMostStreamBytes)
      throw Error(ErrorKind::kOutOfResources, path, "",
                  detail::Concat("is a stream of more than ", kMostStreamBytes >> 30U,
                                 " GiB, of which slamdb reads no more; save it to a file, which may be larger"));
    memory.Resize(size + std::min(size, kLargeStep));
  }
}

std::size_t ReadRegular(detail::OpenedInput& input, const std::string& path, GrowingMemory& memory) {
  const std::size_t size = input.Read(memory.data(), memory.capacity());
  if (size < memory.capacity())
    throw Error(ErrorKind::kDamaged, path, detail::Concat("byte ", size), "the file became shorter while it was read");
  return size;
}

// The bytes in place of those of the mapping that are not used.
std::size_t WholePages(std::size_t bytes) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

}  // namespace

WholeFile::WholeFile(const Source& source, const Look& look) : path_(source.path) {
  if (source.is_file()) detail::EnterInput(path_);
  if (source.memory) {
    bytes_ = *source.memory;
    return;
  }
  detail::OpenedInput input(path_);
  GrowingMemory memory(path_, input.is_stream() ? kFirstBytes : static_cast<std::size_t>(input.size()));
  const std::size_t size =
      input.is_stream() ? ReadStream(input, path_, look, memory) : ReadRegular(input, path_, memory);
  if (size == 0) return;
  reserved_ = WholePages(size);
  if (reserved_ < memory.capacity()) memory.Resize(reserved_);
  bytes_ = {reinterpret_cast<const std::byte*>(memory.data()), size};
  memory.Release();
}

WholeFile::~WholeFile() {
  if (reserved_ > 0) ::munmap(const_cast<std::byte*>(bytes_.data()), reserved_);
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : path_(std::move(other.path_)),
      bytes_(std::exchange(other.bytes_, {})),
      reserved_(std::exchange(other.reserved_, 0)) {}

WholeFile& WholeFile::operator=(WholeFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(bytes_, other.bytes_);
  std::swap(reserved_, other.reserved_);
  return *this;
}

HeldSource::HeldSource(Source source, const WholeFile::Look& look) : source_(std::move(source)) {
  if (source_.memory || !detail::IsStream(source_.path)) return;
  stream_.emplace(source_, look);
  source_.memory = stream_->bytes();
}

Probe Probe::Of(const Source& source) {
  Probe probe{.path = source.path, .head = {}, .memory = source.memory};
  if (source.memory) {
    const Bytes head = source.memory->first(std::min(source.memory->size(), kHeadBytes));
    probe.head.assign(reinterpret_cast<const char*>(head.data()), head.size());
    probe.size = source.memory->size();
    return probe;
  }
  std::error_code unknown;
  probe.is_directory = std::filesystem::is_directory(source.path, unknown);
  if (probe.is_directory || detail::IsStream(source.path)) return probe;
  detail::OpenedInput input(source.path);
  probe.size = input.size();
  probe.head.resize(std::min<std::size_t>(probe.size, kHeadBytes));
  probe.head.resize(input.Read(probe.head.data(), probe.head.size()));
  return probe;
}

}  // namespace slamdb
