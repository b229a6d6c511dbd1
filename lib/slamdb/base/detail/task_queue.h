// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "slamdb/export.h"

namespace slamdb::detail {

// Work that comes piece by piece, as something is read, done on `threads` threads (0: every core) of which the caller
// is one: it works itself where much is waiting. Pieces begin in the order in which they come.
//
//   TaskQueue queue(threads);
//   while (Read(block)) queue.Do([block] { Decode(block); });
//   queue.Finish();
//
// Of one thread: the caller's.
class SLAMDB_EXPORT TaskQueue {
 public:
  explicit TaskQueue(int threads);
  // Waits for what has begun; what is waiting is not done.
  ~TaskQueue();
  TaskQueue(const TaskQueue&) = delete;
  TaskQueue& operator=(const TaskQueue&) = delete;

  // Throws as Finish() does once a piece has failed.
  void Do(std::function<void()> work);
  // Returns when all is done. Rethrows the failure of the first piece that failed, in their order, whatever the
  // threads.
  void Finish();

 private:
  struct Piece {
    std::size_t number = 0;
    std::function<void()> work;
  };
  void Help();
  bool RunNext(std::unique_lock<std::mutex>& lock);
  void StopWaiting(std::unique_lock<std::mutex>& lock);

  std::size_t most_ = 0;  // pieces that wait
  std::mutex mutex_;      // guards what follows
  std::condition_variable changed_;
  std::deque<Piece> waiting_;
  std::size_t numbers_ = 0, running_ = 0;
  std::size_t failed_ = static_cast<std::size_t>(-1);  // the first piece that did
  std::exception_ptr failure_;
  bool is_ended_ = false;
  std::vector<std::jthread> helpers_;
};

}  // namespace slamdb::detail
