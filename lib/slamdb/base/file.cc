// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <new>
#include <utility>

#include "slamdb/base/column.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{64} << 10;
constexpr std::size_t kFirstBytes = std::size_t{1} << 20;  // of memory for a stream, which doubles as it fills

// Memory of columns, so that it may be on disk. Given back unless it is released.
class GrowingMemory {
 public:
  GrowingMemory(const std::string& path, std::size_t bytes) : path_(path), data_(Allocate(bytes)), capacity_(bytes) {}
  ~GrowingMemory() {
    if (data_ != nullptr) FreeColumn(data_, capacity_);
  }
  GrowingMemory(const GrowingMemory&) = delete;
  GrowingMemory& operator=(const GrowingMemory&) = delete;

  char* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }

  void Double() {
    char* const larger = Allocate(2 * capacity_);
    std::memcpy(larger, data_, capacity_);
    FreeColumn(data_, capacity_);
    data_ = larger;
    capacity_ *= 2;
  }
  void Release() { data_ = nullptr; }

 private:
  char* Allocate(std::size_t bytes) const try {
    return static_cast<char*>(AllocateColumn(bytes));
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::kOutOfResources, path_, "", "the machine has too little memory left to read it");
  }

  const std::string& path_;
  char* data_;
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
    memory.Double();
  }
}

std::size_t ReadRegular(detail::OpenedInput& input, const std::string& path, GrowingMemory& memory) {
  const std::size_t size = input.Read(memory.data(), memory.capacity());
  if (size < memory.capacity())
    throw Error(ErrorKind::kDamaged, path, detail::Concat("byte ", size), "the file became shorter while it was read");
  return size;
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
  reserved_ = memory.capacity();
  bytes_ = {reinterpret_cast<const std::byte*>(memory.data()), size};
  memory.Release();
}

WholeFile::~WholeFile() {
  if (reserved_ > 0) FreeColumn(const_cast<std::byte*>(bytes_.data()), reserved_);
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
