// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/spill_file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>
#include <thread>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostAddresses = std::size_t{1} << 42;
constexpr std::size_t kStep = SpillFile::kAlignment;           // by which the hand moves
constexpr std::size_t kChunk = 32 * kStep;                     // room on the disk is taken and given back by so much
constexpr std::size_t kStepsPerLook = 4;                       // at how much memory is taken
constexpr std::uint64_t kTouchedPerMs = 4'000'000;             // bytes, by two cores that read as fast as they can
constexpr std::chrono::milliseconds kSoonest{1}, kLatest{64};  // to look again

std::size_t RoundedUp(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

// A file without a name, also where the file system knows none.
int MakeNamelessFile(const std::string& folder) {
  const int made = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (made >= 0) return made;
  if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL) return -1;
  std::string name = folder + "/slamdb-XXXXXX";
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) ::unlink(name.c_str());
  return file;
}

bool IsInMemory(int file) {
  struct statfs status {};
  return ::fstatfs(file, &status) == 0 && (status.f_type == TMPFS_MAGIC || status.f_type == RAMFS_MAGIC);
}

// Of the process: all of its memory, and what of it are pages of files.
struct Resident {
  std::uint64_t all = 0, of_files = 0;
};

Resident ReadResident(int statm) {
  std::array<char, 128> text{};
  Resident resident;
  if (statm < 0 || ::pread(statm, text.data(), text.size() - 1, 0) <= 0) return resident;
  unsigned long long size = 0, all = 0, of_files = 0;
  if (std::sscanf(text.data(), "%llu %llu %llu", &size, &all, &of_files) != 3) return resident;
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return {all * page, of_files * page};
}

// Signals are for the threads that the program has started.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsHeld() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

SpillFile::SpillFile(const std::string& folder, std::uint64_t limit)
    : folder_(folder),
      file_(MakeNamelessFile(folder)),
      statm_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)),
      limit_(limit) {
  if (file_.value < 0) throw SystemError(folder_, "cannot make a file for what does not fit into memory");
  if (IsInMemory(file_.value))
    throw Error(ErrorKind::kUsage, folder_, "",
                "files there are kept in memory, so what does not fit into it cannot go there; "
                "MemoryLimit::spill_folder names a folder on disk");
  other_files_ = ReadResident(statm_.value).of_files;
  Map();
  StartWatching();
}

SpillFile::~SpillFile() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  if (watcher_.joinable()) watcher_.join();
  ::munmap(map_, map_bytes_);
}

void SpillFile::StartWatching() {
  const SignalsHeld held;
  try {
    watcher_ = std::thread([this] { Watch(); });
  } catch (const std::system_error&) {  // the hand then moves when blocks are taken alone
  }
}

// As many addresses as the system and the file system give; of these only what has been reserved is ever touched.
void SpillFile::Map() {
  constexpr int kProtection = PROT_READ | PROT_WRITE, kFlags = MAP_SHARED | MAP_NORESERVE;
  void* range = MAP_FAILED;
  for (map_bytes_ = kMostAddresses; range == MAP_FAILED && map_bytes_ > kStep;) {
    map_bytes_ /= 2;
    range = ::mmap(nullptr, map_bytes_ + kStep, kProtection, kFlags, file_.value, 0);
  }
  if (range == MAP_FAILED) throw SystemError(folder_, "cannot map a file for what does not fit into memory");
  auto* const begin = static_cast<char*>(range);
  map_ = reinterpret_cast<char*>(RoundedUp(reinterpret_cast<std::uintptr_t>(begin), kStep));
  if (map_ != begin) ::munmap(begin, static_cast<std::size_t>(map_ - begin));
  ::mmap(map_, map_bytes_, kProtection, kFlags | MAP_FIXED, file_.value, 0);  // so that byte 0 of the file is there
  char* const end = begin + map_bytes_ + kStep;
  if (map_ + map_bytes_ != end) ::munmap(map_ + map_bytes_, static_cast<std::size_t>(end - map_ - map_bytes_));
}

char* SpillFile::Take(std::size_t bytes) {
  if (closed_) return nullptr;
  const std::size_t room = RoundedUp(bytes, kStep);
  std::unique_lock lock(mutex_);
  const std::size_t begin = ranges_.Take(room);
  try {
    Reserve(begin, room);
  } catch (...) {
    ranges_.GiveBack(begin, room);
    throw;
  }
  if (taken_ == 0) changed_.notify_all();
  taken_ += room;
  most_ = std::max(most_, taken_);
  Trim(bytes);
  lock.unlock();
#ifdef MADV_POPULATE_WRITE
  // A slab is about to be filled: its pages in one call instead of one fault each. Older kernels refuse, and fault.
  if (bytes <= kStep) ::madvise(map_ + begin, bytes, MADV_POPULATE_WRITE);
#endif
  return map_ + begin;
}

void SpillFile::GiveBack(char* block, std::size_t bytes) noexcept {
  const std::size_t room = RoundedUp(bytes, kStep);
  const auto begin = static_cast<std::size_t>(block - map_);
  const std::lock_guard lock(mutex_);
  taken_ -= room;
  if (closed_ || IsKept(begin)) {
    ::madvise(block, bytes, MADV_DONTNEED);  // of pages that are its own, the memory
    return;
  }
  Unreserve(begin, room);
  try {
    ranges_.GiveBack(begin, room);
  } catch (const std::bad_alloc&) {  // nobody has these addresses again
  }
}

// Calls `use(chunk, bytes)` for each chunk that bytes of a range are in.
template <class Use>
static void ForEachChunk(std::size_t begin, std::size_t bytes, const Use& use) {
  for (const std::size_t end = begin + bytes; begin < end;) {
    const std::size_t chunk = begin / kChunk, next = std::min(end, (chunk + 1) * kChunk);
    use(chunk, next - begin);
    begin = next;
  }
}

void SpillFile::Reserve(std::size_t begin, std::size_t bytes) {
  if (begin + bytes > map_bytes_)
    throw Error(ErrorKind::kOutOfResources, folder_, "",
                Concat("the process has no addresses left for ", HumanBytes(bytes), " more of what does not fit into ",
                       HumanBytes(limit_), " of memory: it may have too few (`ulimit -v`)"));
  taken_of_chunk_.resize(std::max(taken_of_chunk_.size(), (begin + bytes - 1) / kChunk + 1));
  int error = 0;
  ForEachChunk(begin, bytes, [&](std::size_t chunk, std::size_t) {
    if (taken_of_chunk_[chunk] > 0 || error != 0) return;
    do {
      error = ::posix_fallocate(file_.value, static_cast<off_t>(chunk * kChunk), static_cast<off_t>(kChunk));
    } while (error == EINTR);
  });
  if (error != 0) {
    ForEachChunk(begin, bytes, [&](std::size_t chunk, std::size_t) {
      if (taken_of_chunk_[chunk] == 0) Punch(chunk);
    });
    FailToReserve(bytes, error);
  }
  ForEachChunk(begin, bytes, [&](std::size_t chunk, std::size_t taken) { taken_of_chunk_[chunk] += taken; });
}

void SpillFile::Unreserve(std::size_t begin, std::size_t bytes) noexcept {
  ForEachChunk(begin, bytes, [&](std::size_t chunk, std::size_t taken) {
    taken_of_chunk_[chunk] -= taken;
    if (taken_of_chunk_[chunk] == 0) Punch(chunk);
  });
}

void SpillFile::Punch(std::size_t chunk) noexcept {
  ::fallocate(file_.value, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(chunk * kChunk),
              static_cast<off_t>(kChunk));
}

void SpillFile::FailToReserve(std::size_t bytes, int error) const {
  throw Error(ErrorKind::kOutOfResources, folder_, "",
              Concat("the disk has no room for what does not fit into ", HumanBytes(limit_),
                     " of memory: ", HumanBytes(std::max(bytes, kChunk)), " more were asked for, beside ",
                     HumanBytes(taken_), " that are there: ", std::generic_category().message(error),
                     "; MemoryLimit::spill_folder names another, MemoryLimit::bytes allows more memory"));
}

void SpillFile::LetGo() {
  if (closed_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && taken_ > 0) Trim(0);
}

Spilled SpillFile::Use() {
  const std::lock_guard lock(mutex_);
  return {.bytes = taken_, .most = most_, .folder = folder_};
}

// Looks again when as much as is free under the limit can have been touched; less and less often where nothing is free
// and nothing can be let go.
void SpillFile::Watch() {
  std::unique_lock lock(mutex_);
  for (std::chrono::milliseconds wait = kSoonest; !stopped_;) {
    changed_.wait(lock, [this] { return stopped_ || taken_ > 0; });
    const std::uint64_t free = Trim(0);
    wait = free == 0 ? 2 * wait : std::chrono::milliseconds(free / kTouchedPerMs);
    wait = std::clamp(wait, kSoonest, kLatest);
    changed_.wait_for(lock, wait, [this] { return stopped_; });
  }
}

// Makes room for what is about to be touched; returns how much is free then. Moves the hand once round at most: what is
// resident then is not the file's.
std::uint64_t SpillFile::Trim(std::uint64_t soon) {
  const std::uint64_t limit = limit_, most = limit - std::min(soon, limit / 4);
  const auto free = [most](const Resident& resident) { return most - std::min(most, resident.all); };
  Resident resident = ReadResident(statm_.value);
  if (free(resident) > 0) return free(resident);
  const std::uint64_t wanted = most - most / 8;  // a little less, so that the next look finds nothing to do
  const std::uint64_t others = other_files_ + kStepsPerLook * kStep;
  for (std::size_t passed = kept_; passed < ranges_.end(); passed += kStepsPerLook * kStep) {
    for (std::size_t i = 0; i < kStepsPerLook; ++i) PassStep();
    resident = ReadResident(statm_.value);
    if (resident.all <= wanted || resident.of_files <= others) break;
  }
  return free(resident);
}

void SpillFile::PassStep() {
  if (hand_ >= ranges_.end()) hand_ = kept_;
  ::madvise(map_ + hand_, kStep, MADV_DONTNEED);
  hand_ += kStep;
}

// A page that is mapped privately is that of the file until it is written. Done before the fork, so that the processes
// part as with other memory. Of a range that was kept before, pages may have been written: it stays.
void SpillFile::KeepForBoth() {
  const std::size_t end = std::max(ranges_.end(), kept_);
  if (end == kept_ || closed_) return;
  constexpr int kProtection = PROT_READ | PROT_WRITE, kFlags = MAP_PRIVATE | MAP_NORESERVE | MAP_FIXED;
  void* const kept = ::mmap(map_ + kept_, end - kept_, kProtection, kFlags, file_.value, static_cast<off_t>(kept_));
  if (kept == MAP_FAILED) {
    closed_ = true;
    return;
  }
  ranges_.Retire();
  hand_ = kept_ = end;
}

}  // namespace slamdb::detail
