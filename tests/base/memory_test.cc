// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/memory.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
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
#include "tests/base/beyond_the_limit.h"
#include "tests/support/error_of.h"
#include "tests/support/needs_proc.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using detail::FreeMemory;
using detail::FreeRanges;
using detail::SpillFile;
using ::testing::HasSubstr;

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

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
  for (int step = 0; step < 4000; ++step) {
    if (taken.empty() || random() % 2 == 0) {
      const std::size_t bytes = 1 + random() % 9;
      const std::size_t begin = ranges.Take(bytes);
      const auto behind = taken.lower_bound(begin);
      ASSERT_TRUE(behind == taken.end() || begin + bytes <= behind->first);
      ASSERT_TRUE(behind == taken.begin() || std::prev(behind)->first + std::prev(behind)->second <= begin);
      taken.emplace(begin, bytes);
    } else {
      auto gone = std::next(taken.begin(), static_cast<std::ptrdiff_t>(random() % taken.size()));
      ranges.GiveBack(gone->first, gone->second);
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

// Of all files of this process that have no name.
blkcnt_t BlocksOnDisk() {
  blkcnt_t blocks = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    struct stat status {};
    if (::stat(entry.path().c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 0)
      blocks += status.st_blocks;
  }
  return blocks;
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

// As on a disk that is full.
TEST(SpillFile, WhatDoesNotFitLeavesTheDiskAsItWas) {
  SLAMDB_NEEDS_PROC();
  SpillFile file(kOnDisk, kNoLimit);
  char* const block = file.Take(kMegabyte);
  const blkcnt_t before = BlocksOnDisk();
  rlimit usual{};
  ::getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit little{.rlim_cur = 300 * kMegabyte, .rlim_max = usual.rlim_max};
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &little);
  const Error full = ErrorOf([&] { file.Take(1000 * kMegabyte); });
  ::setrlimit(RLIMIT_FSIZE, &usual);
  std::signal(SIGXFSZ, signal_before);
  EXPECT_EQ(full.kind(), ErrorKind::kOutOfResources);
  EXPECT_EQ(BlocksOnDisk(), before);
  EXPECT_EQ(file.Use().bytes, SpillFile::kAlignment);
  file.GiveBack(block, kMegabyte);
}

TEST(SpillFile, BehindAForkBlocksLieBehindThoseThatStay) {
  SpillFile file(kOnDisk, kNoLimit);
  char* const first = file.Take(kMegabyte);
  char* const last = file.Take(kMegabyte);
  file.GiveBack(first, kMegabyte);
  file.BeforeFork();
  file.AfterFork();
  EXPECT_GT(file.Take(kMegabyte), last);
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

// In turn, far more than the limit in all.
TEST_F(ColumnsBeyondTheLimit, OfWhichEachFitsAreInMemory) {
  SetMemoryLimit({.bytes = 512 * kMegabyte, .spill_folder = kOnDisk});
  const std::uint64_t before = SpilledNow().bytes;
  for (int turn = 0; turn < 12; ++turn) {
    const std::vector<Column<std::uint8_t>> large(3, Column<std::uint8_t>(20 * kMegabyte, 1));
    const std::vector<Column<std::uint8_t>> small(2000, Column<std::uint8_t>(1000, 1));
    EXPECT_EQ(SpilledNow().bytes, before) << turn;
  }
}

TEST_F(ColumnsBeyondTheLimit, ThatWentCountNoMore) {
  { const Column<std::uint8_t> on_disk(200 * kMegabyte, 1); }
  SetMemoryLimit({.bytes = 512 * kMegabyte, .spill_folder = kOnDisk});
  const std::uint64_t before = SpilledNow().bytes;
  const Column<std::uint8_t> in_memory(100 * kMegabyte, 1);
  EXPECT_EQ(SpilledNow().bytes, before);
}

// Half of the limit is for columns in memory.
TEST_F(ColumnsBeyondTheLimit, LeaveRoomForAllElse) {
  SetMemoryLimit({.bytes = 256 * kMegabyte, .spill_folder = kOnDisk});
  const std::uint64_t before = SpilledNow().bytes;
  const Column<std::uint8_t> in_memory(90 * kMegabyte, 1);
  EXPECT_EQ(SpilledNow().bytes, before);
  const Column<std::uint8_t> on_disk(90 * kMegabyte, 1);
  EXPECT_GE(SpilledNow().bytes, before + 90 * kMegabyte);
}

}  // namespace
}  // namespace slamdb
