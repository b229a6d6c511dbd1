// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {

// Makes items in order on a thread of its own, one ahead of who takes them: while one is in use the next is being made,
// or ready, and no other.
template <class Item>
class ReadAhead {
 public:
  // make(i) for i from 0 to below count.
  ReadAhead(std::size_t count, std::function<Item(std::size_t)> make)
      : count_(count), make_(std::move(make)), helper_(StartHelpers(1, [this] { Run(); })) {}
  ~ReadAhead() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
  }
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // The next one; `count` may be taken. Rethrows what making it threw. While it waits it calls idle() now and then,
  // which may throw.
  Item Take(const std::function<void()>& idle) {
    if (helper_.empty()) return make_(taken_++);
    std::unique_lock lock(mutex_);
    while (!ready_ && !failure_) {
      constexpr std::chrono::milliseconds kPause(50);
      changed_.wait_for(lock, kPause);
      if (!ready_ && !failure_) {
        lock.unlock();
        idle();
        lock.lock();
      }
    }
    if (!ready_) std::rethrow_exception(failure_);
    Item item = std::move(*ready_);
    ready_.reset();
    changed_.notify_all();
    return item;
  }

 private:
  void Run() {
    for (std::size_t i = 0; i < count_; ++i) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return stop_ || !ready_; });
        if (stop_) return;
      }
      std::optional<Item> item;
      std::exception_ptr failure;
      try {
        item = make_(i);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      ready_ = std::move(item);
      failure_ = failure;
      changed_.notify_all();
      if (failure) return;
    }
  }

  const std::size_t count_;
  const std::function<Item(std::size_t)> make_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Item> ready_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::size_t taken_ = 0;             // where nobody helps
  std::vector<std::jthread> helper_;  // last: it uses the rest
};

}  // namespace slamdb::detail
