// SPDX-License-Identifier: BSD-3-Clause
// Columns on disk in processes that fork.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "slamdb/base/column.h"
#include "tests/base/beyond_the_limit.h"

namespace slamdb {
namespace {

class ForkBeyondTheLimit : public ColumnsBeyondTheLimit {};

// What a child writes, and what it drops, is its own.
TEST_F(ForkBeyondTheLimit, AreEachProcessOwnBehindAFork) {
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
TEST_F(ForkBeyondTheLimit, AreBehindAForkAsTheyWere) {
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

TEST_F(ForkBeyondTheLimit, AreBehindForksOfForksAsTheyWere) {
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

// Blocks of the file are of the process that forked.
TEST_F(ForkBeyondTheLimit, ThatBothMakeBehindAForkAreEachOnesOwn) {
  const Column<std::uint64_t> before(kMegabyte, 5);
  std::vector<Column<std::uint64_t>> made;
  const Later child([&] {
    made.emplace_back(4 * kMegabyte, 6);
    return IsAll(made[0], 6);
  });
  made.emplace_back(4 * kMegabyte, 8);
  EXPECT_TRUE(child.Holds());
  EXPECT_TRUE(IsAll(made[0], 8));
}

// Until no other can be made.
void TakeAllMappings() {
  while (::mmap(nullptr, 1, PROT_READ, MAP_SHARED | MAP_ANONYMOUS, -1, 0) != MAP_FAILED) {
  }
}

bool DropWithoutAMappingLeft() {
  Column<std::uint64_t> dropped(16 * kMegabyte, 6);
  TakeAllMappings();
  const Later child([&] { return IsAll(dropped, 6); });
  dropped = {};
  dropped.shrink_to_fit();
  return child.Holds();
}

// What they write, they then share; what one of them drops stays there for the other.
TEST_F(ForkBeyondTheLimit, AreNotDroppedForTheOtherWithoutAMappingLeft) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";  // in a process of its own, which nobody has forked
  EXPECT_EXIT(::_exit(DropWithoutAMappingLeft() ? 0 : 1), ::testing::ExitedWithCode(0), "");
}

// Another thread may be at the limit, or make the file, at that moment.
TEST_F(ForkBeyondTheLimit, LeaveNothingLockedBehindAFork) {
  std::atomic<bool> done = false;
  const auto set_limits = [&done] {
    while (!done) SetMemoryLimit({.bytes = 1, .spill_folder = kOnDisk});
  };
  const auto make_columns = [&done] {
    while (!done) const Column<std::uint8_t> column(3 * kMegabyte, 1);
  };
  std::vector<std::thread> others;
  for (int i = 0; i < 3; ++i) others.emplace_back(set_limits);
  others.emplace_back(make_columns);
  for (int fork = 0; fork < 100; ++fork) {
    const Later child([] {
      ::alarm(20);  // ends who waits for ever
      SetMemoryLimit({.bytes = 1, .spill_folder = kOnDisk});
      const Column<std::uint8_t> column(3 * kMegabyte, 1);
      return column.back() == 1;
    });
    EXPECT_TRUE(child.Holds()) << fork;
  }
  done = true;
  for (std::thread& other : others) other.join();
}

}  // namespace
}  // namespace slamdb
