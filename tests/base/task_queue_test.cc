// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/task_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace slamdb::detail {
namespace {

class TaskQueueTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, TaskQueueTest, testing::Values(1, 2, 5));

TEST_P(TaskQueueTest, DoesAllThatComes) {
  std::vector<int> done(1000);
  TaskQueue queue(GetParam());
  for (std::size_t i = 0; i < done.size(); ++i) queue.Do([&done, i] { ++done[i]; });
  queue.Finish();
  EXPECT_EQ(done, std::vector<int>(1000, 1));
}

TEST_P(TaskQueueTest, GoesOnAfterFinish) {
  std::atomic<int> done{0};
  TaskQueue queue(GetParam());
  queue.Finish();
  for (int round = 1; round <= 3; ++round) {
    queue.Do([&done] { ++done; });
    queue.Finish();
    EXPECT_EQ(done, round);
  }
}

// Whatever the threads, and whichever fails first in time.
TEST_P(TaskQueueTest, RethrowsTheFirstFailureInOrder) {
  for (int round = 0; round < 20; ++round) {
    TaskQueue queue(GetParam());
    try {
      for (int i = 0; i < 100; ++i)
        queue.Do([i] {
          if (i == 10) std::this_thread::sleep_for(std::chrono::milliseconds(2));
          if (i >= 10) throw std::runtime_error(std::to_string(i));
        });
      queue.Finish();
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), std::string("10"));
    }
  }
}

TEST_P(TaskQueueTest, DoesNoMoreAfterAFailure) {
  std::atomic<int> done{0};
  TaskQueue queue(GetParam());
  EXPECT_THROW(
      {
        for (int i = 0; i < 100000; ++i)
          queue.Do([&done, i] {
            if (i == 0) throw std::runtime_error("first");
            ++done;
          });
        queue.Finish();
      },
      std::runtime_error);
  EXPECT_LT(done, 100000);
}

TEST_P(TaskQueueTest, LeavesWhatWaitsWhereItEndsEarly) {
  std::atomic<int> begun{0}, ended{0};
  {
    TaskQueue queue(GetParam());
    for (int i = 0; i < 8; ++i)
      queue.Do([&] {
        ++begun;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        ++ended;
      });
  }
  EXPECT_EQ(begun, ended);
}

}  // namespace
}  // namespace slamdb::detail
