// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace slamdb {
namespace {

void Append(const std::string& text, Column<char>& buffer) { buffer.insert(buffer.end(), text.begin(), text.end()); }

TEST(ProduceInOrder, HandsBlocksOverInOrderOnTheCallersThread) {
  for (const int threads : {1, 2, 7}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
      std::string taken, expected;
      for (std::size_t i = 0; i < count; ++i) expected += std::to_string(i) + ";";
      const auto caller = std::this_thread::get_id();
      detail::ProduceInOrder(
          count, threads, [](std::size_t i, Column<char>& buffer) { Append(std::to_string(i) + ";", buffer); },
          [&](std::size_t, const Column<char>& buffer) {
            EXPECT_EQ(std::this_thread::get_id(), caller);
            taken.append(buffer.data(), buffer.size());
          });
      EXPECT_EQ(taken, expected);
    }
  }
}

TEST(ProduceInOrder, MakesTextsToo) {
  std::string taken;
  detail::ProduceInOrder<std::string>(
      12, 2, [](std::size_t i, std::string& text) { text += std::to_string(i); },
      [&](std::size_t, const std::string& text) { taken += text; });
  EXPECT_EQ(taken, "01234567891011");
}

TEST(ProduceInOrder, KeepsOnlyAFewBlocks) {
  std::atomic<int> made{0};
  int taken = 0, most_waiting = 0;
  detail::ProduceInOrder(
      500, 3, [&](std::size_t, Column<char>&) { ++made; },
      [&](std::size_t, const Column<char>&) {
        most_waiting = std::max(most_waiting, made - taken);
        ++taken;
      });
  EXPECT_EQ(taken, 500);
  EXPECT_LE(most_waiting, 8);  // two a thread, and those being made
}

TEST(ProduceInOrder, ThrowsTheFirstFailureInOrder) {
  for (const int threads : {1, 4}) {
    std::vector<std::size_t> taken;
    try {
      detail::ProduceInOrder(
          100, threads,
          [](std::size_t i, Column<char>&) {
            if (i == 40 || i == 41) throw std::runtime_error(std::to_string(i));
          },
          [&](std::size_t i, const Column<char>&) { taken.push_back(i); });
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "40");
    }
    EXPECT_EQ(taken.size(), 40U);
  }
}

TEST(ProduceInOrder, StopsWhenTakingThrows) {
  EXPECT_THROW(detail::ProduceInOrder(
                   100, 4, [](std::size_t, Column<char>&) {},
                   [](std::size_t i, const Column<char>&) {
                     if (i == 10) throw std::runtime_error("full disk");
                   }),
               std::runtime_error);
}

}  // namespace
}  // namespace slamdb
