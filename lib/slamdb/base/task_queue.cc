// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/task_queue.h"

#include <utility>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/spill.h"

namespace slamdb::detail {

TaskQueue::TaskQueue(int threads) {
  constexpr std::size_t kWaitingPerThread = 2;
  const auto helpers = static_cast<std::size_t>(ThreadCount(threads)) - 1;
  helpers_ = StartHelpers(helpers, [this] { Help(); });
  most_ = kWaitingPerThread * helpers_.size();
}

TaskQueue::~TaskQueue() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    is_ended_ = true;
  }
  changed_.notify_all();
  helpers_.clear();
}

void TaskQueue::Do(std::function<void()> work) {
  std::unique_lock lock(mutex_);
  if (failure_) StopWaiting(lock);
  waiting_.push_back({numbers_++, std::move(work)});
  if (waiting_.size() > most_)
    RunNext(lock);
  else
    changed_.notify_one();
}

void TaskQueue::Finish() {
  std::unique_lock lock(mutex_);
  while (!failure_ && RunNext(lock)) {
  }
  StopWaiting(lock);
}

// Of pieces that have begun each was before all that wait, so that the first failure is among them.
void TaskQueue::StopWaiting(std::unique_lock<std::mutex>& lock) {
  waiting_.clear();
  changed_.wait(lock, [this] { return running_ == 0; });
  if (failure_) std::rethrow_exception(failure_);
}

void TaskQueue::Help() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ended_ || !waiting_.empty(); });
    if (is_ended_) return;
    RunNext(lock);
  }
}

// The piece that waits longest, without the lock meanwhile; false: none waits.
bool TaskQueue::RunNext(std::unique_lock<std::mutex>& lock) {
  if (waiting_.empty()) return false;
  const Piece piece = std::move(waiting_.front());
  waiting_.pop_front();
  ++running_;
  lock.unlock();
  std::exception_ptr failure;
  try {
    piece.work();
  } catch (...) {
    failure = std::current_exception();
  }
  LetGoOfSpilled();
  lock.lock();
  --running_;
  if (failure && piece.number < failed_) {
    failed_ = piece.number;
    failure_ = failure;
  }
  if (running_ == 0) changed_.notify_all();
  return true;
}

}  // namespace slamdb::detail
