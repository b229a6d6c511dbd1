// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/each.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "slamdb/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;

class EachInput : public ::testing::Test {
 protected:
  void Add(const char* name, std::size_t bytes) {
    folder_.Make(name, std::string(bytes, ' '));
    inputs_.push_back({.location = Location(folder_ / name, "")});
  }

  std::vector<int> ThreadsOfEach(int threads) const {
    const auto outcomes =
        ForEachInput<int>(inputs_, {.threads = threads},
                          [](const AtlasInput&, const ReadOptions& read, Notices&) { return read.threads; });
    std::vector<int> each;
    for (const auto& outcome : outcomes) each.push_back(outcome.result);
    return each;
  }

  TemporaryFolder folder_;
  std::vector<AtlasInput> inputs_;
};

TEST_F(EachInput, HasAThreadWhereManyAreAlike) {
  for (const char* name : {"a", "b", "c", "d"}) Add(name, 1000);
  EXPECT_THAT(ThreadsOfEach(2), ElementsAre(1, 1, 1, 1));
}

TEST_F(EachInput, HasAllThreadsWhereItIsMoreThanTheShareOfOne) {
  for (const char* name : {"a", "b", "c"}) Add(name, 1000);
  Add("large", 3001);
  EXPECT_THAT(ThreadsOfEach(2), ElementsAre(1, 1, 1, 2));
  EXPECT_THAT(ThreadsOfEach(1), ElementsAre(1, 1, 1, 1));
}

TEST_F(EachInput, WithoutFileIsNotLarge) {
  Add("a", 1000);
  inputs_.push_back({.location = Location(folder_ / "nothing", "")});
  inputs_.push_back({.location = Location(folder_ / "a", "of-a-store")});
  EXPECT_THAT(ThreadsOfEach(3), ElementsAre(3, 1, 1));
}

TEST(EachRow, NoneIsTakenBehindTheOneThatThrows) {
  for (int attempt = 0; attempt < 50; ++attempt) {
    std::vector<std::size_t> taken;
    const auto take = [&](std::size_t row) {
      taken.push_back(row);
      if (row != 3) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the others stand at the door
      throw Error(ErrorKind::kOutOfResources, "full");
    };
    EXPECT_EQ(ErrorOf([&] {
                ForEachRow(
                    12, {.threads = 4}, [](std::size_t, const ReadOptions&) {}, take);
              }).kind(),
              ErrorKind::kOutOfResources);
    ASSERT_THAT(taken, ElementsAre(0, 1, 2, 3)) << attempt;
  }
}

TEST(EachRow, WorkIsOnlySomeRowsAhead) {
  constexpr std::size_t kRows = 2000, kMost = 100;
  std::atomic<std::size_t> begun = 0;
  std::size_t farthest = 0;
  const auto work = [&](std::size_t row, const ReadOptions&) {
    ++begun;
    if (row == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };
  ForEachRow(kRows, {.threads = 2}, work, [&](std::size_t row) { farthest = std::max(farthest, begun - row); });
  EXPECT_LT(farthest, kMost);
}

TEST(EachRow, WhereOneFailsNobodyWaits) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const auto work = [](std::size_t row, const ReadOptions&) {
      if (row > 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the others are as far ahead as they may be
      throw Error(ErrorKind::kDamaged, "broken");
    };
    EXPECT_EQ(ErrorOf([&] { ForEachRow(2000, {.threads = 4}, work, [](std::size_t) {}); }).kind(), ErrorKind::kDamaged);
  }
}

}  // namespace
}  // namespace slamdb
