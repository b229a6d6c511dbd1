// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/file_stream.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kBlock = std::size_t{2} << 20;  // a huge page
constexpr std::size_t kPiece = std::size_t{1}
                               << 15;  // read at once: little lies in the window of what could be left out
constexpr int kReadWrite = PROT_READ | PROT_WRITE;

std::size_t Blocks(std::size_t bytes) { return (bytes + kBlock - 1) / kBlock; }

// Moves the memory behind a block of addresses to another. The old addresses must stay reserved: a mapping that
// somebody else got there would go away with ours. Where the kernel cannot do that, the memory is given back.
bool MoveMemory(char* from, char* to) {
#ifdef MREMAP_DONTUNMAP
  constexpr int kMove = MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP;
  if (::mremap(from, kBlock, kBlock, kMove, to) != MAP_FAILED) return true;
#endif
  ::madvise(from, kBlock, MADV_DONTNEED);
  return false;
}

}  // namespace

FileStream::FileStream(const Source& source, const WholeFile::Look& look) : path_(source.path) {
  if (!source.memory && !IsStream(path_)) file_.emplace(path_);
  if (file_ && !file_->is_stream()) {
    EnterInput(path_);
    size_ = static_cast<std::size_t>(file_->size());
    ReserveAddresses(Blocks(size_) * kBlock);
    return;
  }
  stream_.emplace(source, look);
  data_ = stream_->text().data();
  size_ = filled_ = stream_->text().size();
}

FileStream::~FileStream() {
  if (reserved_ != nullptr) ::munmap(reserved_, reserved_bytes_);
}

void FileStream::ReserveAddresses(std::size_t bytes) {
  reserved_bytes_ = bytes + kBlock;
  void* range = ::mmap(nullptr, reserved_bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (range == MAP_FAILED) throw SystemError(path_, "cannot reserve addresses for the file");
  reserved_ = static_cast<char*>(range);
  data_ = window_ = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(reserved_) + kBlock - 1) & ~(kBlock - 1));
}

// Puts memory behind the next block of addresses: that of a released block if there is one.
void FileStream::AddBlock() {
  char* const block = window_ + backed_;
  char* spare = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      spare = spare_.back();
      spare_.pop_back();
    }
  }
  if (spare == nullptr || !MoveMemory(spare, block)) {
    if (::mprotect(block, kBlock, kReadWrite) != 0) throw SystemError(path_, "cannot reserve memory");
#ifdef MADV_HUGEPAGE
    ::madvise(block, kBlock, MADV_HUGEPAGE);
#endif
  }
  backed_ += kBlock;
}

void FileStream::FillTo(std::size_t offset) {
  if (offset <= filled_) return;
  const std::size_t wanted = std::min(size_, std::max(offset, filled_ + kPiece));
  while (filled_ < wanted) {
    while (backed_ <= filled_) AddBlock();
    const std::size_t bytes = std::min(wanted, backed_) - filled_;
    ReadAt(filled_, window_ + filled_, bytes);
    filled_ += bytes;
  }
}

void FileStream::ReadAt(std::size_t offset, char* to, std::size_t bytes) const {
  const std::size_t size = file_->ReadAt(offset, to, bytes);
  if (size != bytes)
    throw Error(ErrorKind::kDamaged, path_, "byte " + std::to_string(offset + size),
                "the file became shorter while it was read");
}

void FileStream::LeaveOut(std::size_t offset) {
  offset = std::min(offset, size_);
  if (offset <= filled_) return;
  while (backed_ < offset) AddBlock();  // so that any block can be released
  const std::lock_guard lock(mutex_);
  holes_.push_back({filled_, offset});
  filled_ = offset;
}

// The first hole that begins or ends between the two, or an empty one at the end.
FileStream::Hole FileStream::FirstHole(std::size_t begin, std::size_t end) {
  const std::lock_guard lock(mutex_);
  const auto hole = std::ranges::upper_bound(holes_, begin, {}, &Hole::end);
  if (hole == holes_.end() || hole->begin >= end) return {end, end};
  return {std::max(begin, hole->begin), std::min(end, hole->end)};
}

void FileStream::Copy(std::size_t offset, std::size_t bytes, char* to) {
  for (const std::size_t end = offset + bytes; offset < end;) {
    const Hole hole = window_ == nullptr ? Hole{end, end} : FirstHole(offset, end);
    std::memcpy(to, data_ + offset, hole.begin - offset);
    if (hole.end > hole.begin) ReadAt(hole.begin, to + (hole.begin - offset), hole.end - hole.begin);
    to += hole.end - offset;
    offset = hole.end;
  }
}

void FileStream::Release(std::size_t offset) {
  if (window_ == nullptr) return;
  const std::lock_guard lock(mutex_);
  for (; (released_ + 1) * kBlock <= offset; ++released_) spare_.push_back(window_ + released_ * kBlock);
  while (!holes_.empty() && holes_.front().end <= offset) holes_.pop_front();
}

}  // namespace slamdb::detail
