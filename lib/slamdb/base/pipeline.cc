// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/pipeline.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

using Make = std::function<void(std::size_t, Column<char>&)>;

class Pipeline {
 public:
  Pipeline(std::size_t count, std::size_t helpers, const Make& make)
      : count_(count), make_(make), slots_(2 * (helpers + 1)) {
    for (std::size_t i = 0; i < helpers; ++i) helpers_.emplace_back([this] { Help(); });
  }
  ~Pipeline() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    helpers_.clear();
  }
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Block `i`, made by a helper or here and now.
  const Column<char>& Wait(std::size_t i) {
    Slot& slot = SlotOf(i);
    std::unique_lock lock(mutex_);
    while (!slot.ready) {
      if (next_ < std::min(count_, taken_ + slots_.size()))
        MakeNext(lock);
      else
        changed_.wait(lock);
    }
    if (slot.failure) std::rethrow_exception(slot.failure);
    return slot.buffer;
  }
  void Taken(std::size_t i) {
    {
      const std::lock_guard lock(mutex_);
      SlotOf(i).ready = false;
      taken_ = i + 1;
    }
    changed_.notify_all();
  }

 private:
  struct Slot {
    Column<char> buffer;
    std::exception_ptr failure;
    bool ready = false;
  };
  Slot& SlotOf(std::size_t i) { return slots_[i % slots_.size()]; }

  void Help() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stopped_ || next_ >= count_ || next_ < taken_ + slots_.size(); });
      if (stopped_ || next_ >= count_) return;
      MakeNext(lock);
    }
  }
  // Takes the next block that nobody makes and makes it, without holding the lock meanwhile.
  void MakeNext(std::unique_lock<std::mutex>& lock) {
    const std::size_t i = next_++;
    Slot& slot = SlotOf(i);
    lock.unlock();
    std::exception_ptr failure;
    slot.buffer.clear();
    try {
      make_(i, slot.buffer);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    slot.failure = failure;
    slot.ready = true;
    changed_.notify_all();
  }

  const std::size_t count_;
  const Make& make_;
  std::vector<Slot> slots_;
  std::mutex mutex_;  // guards what follows, and the slots' `ready` and `failure`
  std::condition_variable changed_;
  std::size_t next_ = 0;   // the first block that nobody makes yet
  std::size_t taken_ = 0;  // blocks handed over
  bool stopped_ = false;
  std::vector<std::jthread> helpers_;
};

}  // namespace

void ProduceInOrder(std::size_t count, int threads, const Make& make,
                    const std::function<void(std::size_t, const Column<char>&)>& take) {
  if (count == 0) return;
  const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(ThreadCount(threads)), count) - 1;
  Pipeline pipeline(count, helpers, make);
  for (std::size_t i = 0; i < count; ++i) {
    take(i, pipeline.Wait(i));
    pipeline.Taken(i);
  }
}

}  // namespace slamdb::detail
