// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/change_gate.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "slamdb/base/error.h"

namespace slamdb::live {
namespace {

TEST(ChangeGate, ShowsAClosedGateNoHalfChange) {
  ChangeGate gate;
  int a = 0, b = 0;  // equal but inside a change; one thread of two changes them at a time
  std::mutex mutex;
  std::atomic<bool> done = false;
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back([&] {
      while (!done) {
        const Change outer(gate);
        const std::lock_guard<std::mutex> lock(mutex);
        ++a;
        const Change inner(gate);
        ++b;
      }
    });
  for (int i = 0; i < 200; ++i) {
    const ClosedGate closed(gate);
    ASSERT_EQ(a, b);
  }
  done = true;
  for (std::thread& thread : threads) thread.join();
}

TEST(ChangeGate, ClosesOneAtATime) {
  ChangeGate gate;
  int count = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 100; ++k) {
        const ClosedGate closed(gate);
        ++count;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(count, 400);
}

TEST(ChangeGate, RefusesToWaitForItself) {
  ChangeGate gate, other;
  const Change change(gate);
  EXPECT_THROW(const ClosedGate refused(gate), Error);
  const ClosedGate closed(other);
}

}  // namespace
}  // namespace slamdb::live
