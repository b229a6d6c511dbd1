// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/parallel.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace slamdb {
namespace {

TEST(ThreadCount, TakesEveryCoreForZero) {
  EXPECT_EQ(detail::ThreadCount(3), 3);
  EXPECT_GE(detail::ThreadCount(0), 1);
}

TEST(ThreadCount, CountsCoresThatTheProcessMayRunOn) {
  cpu_set_t before, one;
  ASSERT_EQ(::sched_getaffinity(0, sizeof(before), &before), 0);
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(::sched_setaffinity(0, sizeof(one), &one), 0);
  EXPECT_EQ(detail::ThreadCount(0), 1);
  ASSERT_EQ(::sched_setaffinity(0, sizeof(before), &before), 0);
  EXPECT_EQ(detail::ThreadCount(0), CPU_COUNT(&before));
}

TEST(ParallelFor, CallsForEachElementOnce) {
  for (const int threads : {1, 2, 5}) {
    for (const std::size_t grain : {0U, 1U, 7U, 1000U, 100000U}) {
      std::vector<std::atomic<int>> calls(1003);
      detail::ParallelFor(calls.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++calls[i];
      });
      for (const std::atomic<int>& count : calls) ASSERT_EQ(count, 1);
    }
  }
}

TEST(ParallelFor, DoesNothingForNothing) {
  detail::ParallelFor(0, 10, 4, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(ParallelFor, RunsInTheCallerWithOneThread) {
  const std::thread::id caller = std::this_thread::get_id();
  detail::ParallelFor(100, 10, 1, [&](std::size_t, std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(ParallelFor, UsesSeveralThreads) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  detail::ParallelFor(4, 1, 2, [&](std::size_t, std::size_t) {
    {
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  EXPECT_EQ(threads.size(), 2U);
}

TEST(ParallelFor, RethrowsTheFirstException) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(detail::ParallelFor(1000, 1, threads,
                                     [](std::size_t begin, std::size_t) {
                                       if (begin % 100 == 50 || begin == 0) throw std::runtime_error("failed");
                                     }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace slamdb
