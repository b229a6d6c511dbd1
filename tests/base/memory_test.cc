// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/memory.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "slamdb/base/column.h"
#include "slamdb/base/detail/free_memory.h"
#include "slamdb/base/detail/free_ranges.h"
#include "slamdb/base/detail/sanitizers.h"
#include "slamdb/base/detail/spill_file.h"
#include "slamdb/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/needs_proc.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using detail::FreeMemory;
using detail::FreeRanges;
using detail::SpillFile;
using ::testing::HasSubstr;

constexpr std::size_t kMegabyte = std::size_t{1} << 20;
constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
constexpr const char* kOnDisk = "/var/tmp";

std::uint64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// What differs for every block and everywhere in it.
void Fill(char* block, std::size_t bytes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i + 8 <= bytes; i += 512) {
    const std::uint64_t value = random();
    std::memcpy(block + i, &value, 8);
  }
}
bool Holds(const char* block, std::size_t bytes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i + 8 <= bytes; i += 512) {
    const std::uint64_t value = random();
    if (std::memcmp(block + i, &value, 8) != 0) return false;
  }
  return true;
}

TEST(FreeRanges, TakesWhatIsFreeAndNothingTwice) {
  std::mt19937 random(3);
  FreeRanges ranges;
  std::map<std::size_t, std::size_t> taken;
  std::size_t sum = 0;
  for (int step = 0; step < 4000; ++step) {
    if (taken.empty() || random() % 2 == 0) {
      const std::size_t bytes = 1 + random() % 9;
      const std::size_t begin = ranges.Take(bytes);
      const auto behind = taken.lower_bound(begin);
      ASSERT_TRUE(behind == taken.end() || begin + bytes <= behind->first);
      ASSERT_TRUE(behind == taken.begin() || std::prev(behind)->first + std::prev(behind)->second <= begin);
      taken.emplace(begin, bytes);
      sum += bytes;
    } else {
      auto gone = std::next(taken.begin(), static_cast<std::ptrdiff_t>(random() % taken.size()));
      ranges.GiveBack(gone->first, gone->second);
      sum -= gone->second;
      taken.erase(gone);
    }
    ASSERT_EQ(ranges.end(), taken.empty() ? 0 : taken.rbegin()->first + taken.rbegin()->second);
  }
  while (!taken.empty()) {
    ranges.GiveBack(taken.begin()->first, taken.begin()->second);
    taken.erase(taken.begin());
  }
  EXPECT_EQ(ranges.end(), 0U);
}

TEST(FreeRanges, FillsGaps) {
  FreeRanges ranges;
  for (int i = 0; i < 4; ++i) ranges.Take(10);
  ranges.GiveBack(0, 10);
  ranges.GiveBack(20, 10);
  ranges.GiveBack(10, 10);
  EXPECT_EQ(ranges.Take(30), 0U);
  EXPECT_EQ(ranges.Take(1), 40U);
}

// ---- what is free

class FreeMemoryOf : public ::testing::Test {
 protected:
  void Put(const std::string& path, const std::string& text) {
    const std::filesystem::path file = folder_.path() / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  std::uint64_t Free() const { return FreeMemory(folder_.path().string()); }

  const TemporaryFolder folder_;
};

TEST_F(FreeMemoryOf, UnknownSystemsIsUnlimited) { EXPECT_EQ(Free(), kNoLimit); }

TEST_F(FreeMemoryOf, LinuxIsWhatIsAvailable) {
  Put("proc/meminfo", "MemTotal:       8000 kB\nMemFree:        1000 kB\nMemAvailable:   3000 kB\n");
  EXPECT_EQ(Free(), 3000U * 1024);
}

TEST_F(FreeMemoryOf, GroupsOfVersion2IsTheLeastOfAllAbove) {
  Put("proc/meminfo", "MemAvailable:   3000 kB\n");
  Put("proc/self/cgroup", "0::/a/b\n");
  Put("sys/fs/cgroup/a/b/memory.max", "max\n");
  Put("sys/fs/cgroup/a/b/memory.current", "700000\n");
  EXPECT_EQ(Free(), 3000U * 1024);
  Put("sys/fs/cgroup/a/memory.max", "1000000\n");
  Put("sys/fs/cgroup/a/memory.current", "700000\n");
  EXPECT_EQ(Free(), 300000U);
  Put("sys/fs/cgroup/a/memory.stat", "anon 1\nactive_file 100000\ninactive_file 50000\n");
  EXPECT_EQ(Free(), 450000U);
}

TEST_F(FreeMemoryOf, GroupsOfVersion1InAContainerIsThatOfTheRoot) {
  Put("proc/self/cgroup", "9:cpu:/x\n4:memory:/docker/1f3a\n");
  Put("sys/fs/cgroup/memory/memory.limit_in_bytes", "1000000\n");
  Put("sys/fs/cgroup/memory/memory.usage_in_bytes", "1200000\n");
  EXPECT_EQ(Free(), 0U);
  Put("sys/fs/cgroup/memory/memory.stat", "inactive_file 5\ntotal_active_file 0\ntotal_inactive_file 400000\n");
  EXPECT_EQ(Free(), 200000U);
}

TEST_F(FreeMemoryOf, DamagedFilesIsUnlimited) {
  Put("proc/meminfo", "MemAvailable:\nMemAvailable");
  Put("proc/self/cgroup", ":\n::\n\n0\n4:memory\n");
  EXPECT_EQ(Free(), kNoLimit);
}

// ---- the file

TEST(SpillFile, KeepsWhatIsPutInAndTheMemoryUnderTheLimit) {
  SLAMDB_NEEDS_PROC();
  if (SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER) GTEST_SKIP() << "a sanitizer takes memory of its own";
  constexpr std::size_t kBlock = 6 * kMegabyte, kBlocks = 40;
  const std::uint64_t limit = ResidentBytes() + 48 * kMegabyte;
  SpillFile file(kOnDisk, limit);
  std::vector<char*> blocks;
  std::uint64_t most = 0;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    blocks.push_back(file.Take(kBlock));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(blocks.back()) % SpillFile::kAlignment, 0U);
    Fill(blocks.back(), kBlock, i);
    most = std::max(most, ResidentBytes());
  }
  EXPECT_LE(most, limit + 2 * kBlock);
  EXPECT_EQ(file.Use().bytes, kBlocks * kBlock);
  for (std::size_t i = 0; i < kBlocks; ++i) EXPECT_TRUE(Holds(blocks[i], kBlock, i)) << i;
  for (char* block : blocks) file.GiveBack(block, kBlock);
  EXPECT_EQ(file.Use().bytes, 0U);
  EXPECT_EQ(file.Use().most, kBlocks * kBlock);
}

// Nobody takes blocks while what is there is looked at: the thread alone lets go.
TEST(SpillFile, LetsGoOfWhatIsReadAgain) {
  SLAMDB_NEEDS_PROC();
  if (SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER) GTEST_SKIP() << "a sanitizer takes memory of its own";
  constexpr std::size_t kBytes = 160 * kMegabyte;
  SpillFile file(kOnDisk, kNoLimit);
  char* const block = file.Take(kBytes);
  Fill(block, kBytes, 7);
  const std::uint64_t full = ResidentBytes();
  file.SetLimit(full - 100 * kMegabyte);
  for (int look = 0; look < 5000 && ResidentBytes() > full - 100 * kMegabyte; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_LE(ResidentBytes(), full - 100 * kMegabyte);
  EXPECT_TRUE(Holds(block, kBytes, 7));
}

TEST(SpillFile, UsesTheSameRoomAgain) {
  SpillFile file(kOnDisk, kNoLimit);
  char* const first = file.Take(3 * kMegabyte);
  char* const second = file.Take(3 * kMegabyte);
  Fill(first, 3 * kMegabyte, 1);
  Fill(second, 3 * kMegabyte, 2);
  file.GiveBack(first, 3 * kMegabyte);
  char* const again = file.Take(kMegabyte);
  EXPECT_EQ(again, first);
  EXPECT_TRUE(Holds(second, 3 * kMegabyte, 2));
}

// Of the file of this process that has no name.
blkcnt_t BlocksOnDisk() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    struct stat status {};
    if (::stat(entry.path().c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 0)
      return status.st_blocks;
  }
  return -1;
}

TEST(SpillFile, GivesTheDiskBack) {
  SLAMDB_NEEDS_PROC();
  constexpr std::size_t kBlock = 100 * kMegabyte;
  SpillFile file(kOnDisk, kNoLimit);
  char* const first = file.Take(kBlock);
  char* const second = file.Take(kBlock);
  const blkcnt_t both = BlocksOnDisk();
  EXPECT_GE(both, static_cast<blkcnt_t>(2 * kBlock / 512));  // room is there before anything is put in
  Fill(second, kBlock, 2);
  file.GiveBack(first, kBlock);
  const blkcnt_t one = BlocksOnDisk();
  EXPECT_LT(one, both);
  EXPECT_TRUE(Holds(second, kBlock, 2));
  file.GiveBack(second, kBlock);
  EXPECT_LT(BlocksOnDisk(), one);
}

TEST(SpillFile, LeavesNothingInTheFolder) {
  const TemporaryFolder folder;
  try {
    SpillFile file(folder.path().string(), kNoLimit);
    file.Take(kMegabyte);
    EXPECT_TRUE(folder.Names().empty());
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("kept in memory"));  // the tests' folder is
  }
}

TEST(SpillFile, TellsWhichFolderItCannotUse) {
  const Error missing = ErrorOf([] { SpillFile file("/var/tmp/slamdb/is/not/there", kNoLimit); });
  EXPECT_EQ(missing.kind(), ErrorKind::kNotFound);
  EXPECT_EQ(missing.path(), "/var/tmp/slamdb/is/not/there");
  if (!std::filesystem::is_directory("/dev/shm")) GTEST_SKIP() << "/dev/shm is not there";
  const Error memory = ErrorOf([] { SpillFile file("/dev/shm", kNoLimit); });
  EXPECT_EQ(memory.kind(), ErrorKind::kUsage);
  EXPECT_THAT(memory.what(), HasSubstr("MemoryLimit::spill_folder"));
}

// ---- columns

class ColumnsBeyondTheLimit : public ::testing::Test {
 protected:
  void SetUp() override {
    if (SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER) GTEST_SKIP() << "columns are plain memory";
    SetMemoryLimit({.bytes = 1, .spill_folder = kOnDisk});
  }
  void TearDown() override { SetMemoryLimit({}); }
};

TEST_F(ColumnsBeyondTheLimit, AreOnDiskAndHoldWhatIsPutIn) {
  const std::uint64_t before = SpilledNow().bytes;
  std::vector<Column<std::uint64_t>> columns(64);
  std::vector<std::thread> makers;
  for (std::size_t maker = 0; maker < 4; ++maker) {
    makers.emplace_back([&columns, maker] {
      for (std::size_t i = maker; i < columns.size(); i += 4) columns[i].assign(i * 3000, i);
    });
  }
  for (std::thread& maker : makers) maker.join();
  EXPECT_GT(SpilledNow().bytes, before + 8 * kMegabyte);
  EXPECT_EQ(SpilledNow().folder, kOnDisk);
  for (std::size_t i = 0; i < columns.size(); ++i)
    EXPECT_EQ(std::accumulate(columns[i].begin(), columns[i].end(), std::uint64_t{0}), i * 3000 * i);
  columns.clear();
  EXPECT_LE(SpilledNow().bytes, before + 5 * SpillFile::kAlignment);  // slabs that threads cut from
}

TEST_F(ColumnsBeyondTheLimit, StayWhereTheyAreWhenItIsLifted) {
  Column<std::uint64_t> column(kMegabyte, 5);
  SetMemoryLimit({});
  const std::uint64_t before = SpilledNow().bytes;
  const Column<std::uint64_t> copy = column;
  EXPECT_EQ(SpilledNow().bytes, before);
  column.clear();
  column.shrink_to_fit();
  EXPECT_LT(SpilledNow().bytes, before);
  EXPECT_EQ(copy.back(), 5U);
}

// What a child writes, and what it drops, is its own.
TEST_F(ColumnsBeyondTheLimit, AreEachProcessOwnBehindAFork) {
  Column<std::uint64_t> kept(kMegabyte, 5), dropped(kMegabyte, 6);
  const pid_t child = ::fork();
  if (child == 0) {
    const bool same = kept.front() == 5 && kept.back() == 5 && dropped.back() == 6;
    std::fill(kept.begin(), kept.end(), 7);
    dropped = {};
    dropped.shrink_to_fit();
    const Column<std::uint64_t> made(2 * kMegabyte, 8);
    ::_exit(same && made.back() == 8 && kept.front() == 7 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(std::all_of(kept.begin(), kept.end(), [](std::uint64_t value) { return value == 5; }));
  EXPECT_TRUE(std::all_of(dropped.begin(), dropped.end(), [](std::uint64_t value) { return value == 6; }));
}

// A process that goes on when it is told to.
class Later {
 public:
  explicit Later(const std::function<bool()>& holds) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    child_ = ::fork();
    if (child_ != 0) return;
    char told = 0;
    const bool is_told = ::read(ends_[0], &told, 1) == 1;
    ::_exit(is_told && holds() ? 0 : 1);
  }
  ~Later() {
    for (const int end : ends_) ::close(end);
  }
  Later(const Later&) = delete;
  Later& operator=(const Later&) = delete;

  bool Holds() const {
    int status = -1;
    return ::write(ends_[1], "x", 1) == 1 && ::waitpid(child_, &status, 0) == child_ && status == 0;
  }

 private:
  std::array<int, 2> ends_{};
  pid_t child_ = -1;
};

bool IsAll(const Column<std::uint64_t>& column, std::uint64_t value) {
  return std::all_of(column.begin(), column.end(), [value](std::uint64_t each) { return each == value; });
}

// What the first process writes, drops and makes after that is not seen by the other.
TEST_F(ColumnsBeyondTheLimit, AreBehindAForkAsTheyWere) {
  Column<std::uint64_t> written(4 * kMegabyte, 5), dropped(4 * kMegabyte, 6);
  const Later child([&] { return IsAll(written, 5) && IsAll(dropped, 6); });
  std::fill(written.begin(), written.end(), 7);
  dropped = {};
  dropped.shrink_to_fit();
  Column<std::uint64_t> made(16 * kMegabyte, 8);
  EXPECT_GT(SpilledNow().bytes, 0U);
  EXPECT_TRUE(child.Holds());
  EXPECT_TRUE(IsAll(written, 7));
  EXPECT_TRUE(IsAll(made, 8));
}

TEST_F(ColumnsBeyondTheLimit, AreBehindForksOfForksAsTheyWere) {
  Column<std::uint64_t> column(4 * kMegabyte, 5);
  const Later child([&] {
    std::fill(column.begin(), column.end(), 6);
    const Later grandchild([&] { return IsAll(column, 6); });
    std::fill(column.begin(), column.end(), 7);
    return grandchild.Holds() && IsAll(column, 7);
  });
  Column<std::uint64_t> more(4 * kMegabyte, 8);
  const Later second([&] { return IsAll(column, 5) && IsAll(more, 8); });
  std::fill(more.begin(), more.end(), 9);
  EXPECT_TRUE(child.Holds());
  EXPECT_TRUE(IsAll(column, 5));
  EXPECT_TRUE(second.Holds());
}

}  // namespace
}  // namespace slamdb
